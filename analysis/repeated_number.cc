#include "pliant/analysis/repeated_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "pliant/analysis/bootstrap.h"
#include "pliant/analysis/summary.h"
#include "pliant/analysis/with_unit.h"
#include "pliant/systems/nearest_name.h"

namespace pliant {

namespace {

double Mean(const std::vector<double>& values) { return Summarize(values).mean; }

/// A spread that is round-off is none: what repeats exactly has no distribution.
bool Scatters(const std::vector<double>& values) {
  if (values.size() < 2) return false;
  const auto [least, most] = std::ranges::minmax(values);
  return most - least > 1e-12 * std::max(std::abs(least), std::abs(most));
}

std::string IntervalOfMean(const RepeatedNumber::OfRun& of, const std::string& unit) {
  if (!Scatters(of.values)) return "–";
  return IntervalText(BootstrapOf(of.values, Mean).interval, unit);
}

}  // namespace

bool RepeatedNumber::OfRun::finite() const {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

RepeatedNumber::RepeatedNumber(SignalNumber number, std::vector<std::string> runs)
    : number_{std::move(number)} {
  for (std::string& run : runs) runs_.push_back({.run = std::move(run), .title = {}});
}

void RepeatedNumber::Add(const Runs& repetition) {
  for (OfRun& of : runs_) {
    const RunData& run = repetition[of.run];
    const RecordedSignal& recorded = run.log[number_.signal];
    text_ = number_.text(recorded);
    unit_ = number_.unit(recorded);
    of.title = run.title;
    of.values.push_back(number_.Of(run.log));
  }
}

const RepeatedNumber::OfRun& RepeatedNumber::operator[](std::string_view run) const {
  const auto found = std::ranges::find(runs_, run, &OfRun::run);
  if (found != runs_.end()) return *found;
  std::vector<std::string> names;
  for (const OfRun& of : runs_) names.push_back(of.run);
  throw Error("there is no run '" + std::string(run) + "'" + DidYouMean(run, names));
}

Table NumbersTable(const std::vector<RepeatedNumber>& numbers) {
  Table table{.title = "Numbers over all repetitions",
              .columns = {"", "run", "n", "mean", "SD", "95 % interval of the mean", "median"},
              .rows = {},
              .caption =
                  "SD: standard deviation. Intervals: bias-corrected and accelerated bootstrap, "
                  "10 000 resamples; none where nothing scatters. Where some repetition has no "
                  "finite number, only the median is given."};
  std::set<std::pair<std::string, std::string>> seen;
  for (const RepeatedNumber& number : numbers)
    for (const RepeatedNumber::OfRun& of : number.runs()) {
      if (!seen.insert({number.text(), of.run}).second) continue;
      std::vector<std::string> row{number.text(), of.title, std::to_string(of.values.size())};
      if (of.finite()) {
        const Summary s = Summarize(of.values);
        row.insert(row.end(),
                   {WithUnit(s.mean, number.unit()), WithUnit(s.standard_deviation, number.unit()),
                    IntervalOfMean(of, number.unit()), WithUnit(s.median, number.unit())});
      } else {
        std::vector<double> sorted = of.values;
        const auto middle = sorted.begin() + std::ssize(sorted) / 2;
        std::ranges::nth_element(sorted, middle, [](double a, double b) {
          return a < b || (std::isnan(b) && !std::isnan(a));
        });
        row.insert(row.end(), {"–", "–", "–", WithUnit(*middle, number.unit())});
      }
      table.rows.push_back(std::move(row));
    }
  return table;
}

std::string MeanAndDeviation(const std::vector<double>& values, const std::string& unit) {
  const Summary s = Summarize(values);
  return WithUnit(s.mean, unit) +
         (values.size() > 1 ? " ± " + WithUnit(s.standard_deviation, unit) : "");
}

std::string IntervalText(const Interval& interval, const std::string& unit) {
  return WithUnit(interval.lower, unit) + " … " + WithUnit(interval.upper, unit);
}

std::string PText(double p) {
  if (p < 1e-300) return "p < 1e-300";
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "p = %.2g", p);
  return text.data();
}

std::optional<Interval> IntervalOfDifference(const std::vector<double>& first,
                                             const std::vector<double>& second) {
  if (!Scatters(first) && !Scatters(second)) return std::nullopt;
  if (first.size() < 2 || second.size() < 2) return std::nullopt;
  return BootstrapOfDifference(first, second, Mean).interval;
}

std::optional<std::string> WhyNotComparable(const RepeatedNumber& numbers) {
  for (const RepeatedNumber::OfRun& of : numbers.runs()) {
    const auto count = std::ranges::count_if(of.values, [](double x) { return !std::isfinite(x); });
    if (count > 0)
      return "cannot be judged: " + numbers.text() + " is not finite in " + Text(count) + " of " +
             Text(of.values.size()) + " repetitions of " + of.title;
  }
  return std::nullopt;
}

}  // namespace pliant
