#include "pliant/analysis/order_claim.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "pliant/analysis/summary.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

/// Of one repetition, or the medians: a number for each run.
bool IsOrdered(const OrderClaim& of, const std::vector<double>& numbers) {
  const double sign = of.direction == OrderDirection::Rising ? 1 : -1;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const double x = numbers[i - 1], y = numbers[i];
    // ∞ as the former has no part that could be a margin.
    const double part = of.margin_part == 0 ? 0 : of.margin_part * std::abs(x);
    if (!(sign * (y - x) > std::max(of.margin, part))) return false;
  }
  return true;
}

std::string Listed(const std::vector<std::string>& titles, const std::vector<double>& numbers,
                   const std::string& unit) {
  std::string all;
  for (std::size_t i = 0; i < titles.size(); ++i)
    all += (i ? ", " : "") + titles[i] + " " + WithUnit(numbers[i], unit);
  return all;
}

double Median(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); })
             ? Summarize(values).median
             : NAN;
}

std::string CriterionOf(const OrderClaim& of, const std::string& unit, bool repeated) {
  std::string text = of.direction == OrderDirection::Rising ? "rises" : "falls";
  text += " from each to the next";
  if (of.margin > 0) text += " by more than " + WithUnit(of.margin, unit);
  if (of.margin_part > 0)
    text += std::string(of.margin > 0 ? " and" : " by more than") + " " +
            Text(100 * of.margin_part) + " %";
  if (of.of == OrderOf::Medians) return "the median " + text;
  return repeated ? text + ", in every repetition" : text;
}

}  // namespace

void OrderClaim::RequireFit(const Scenario& scenario) const {
  Require(runs.size() >= 2, "an order is of 2 runs or more", runs.size());
  Require(std::set<std::string>(runs.begin(), runs.end()).size() == runs.size(),
          "a run stands twice in the order");
  number.RequireFit(scenario);
}

Claim OrderClaim::Judge(const RepeatedNumber& measured) const {
  const std::size_t n = measured.repetitions();
  std::vector<std::string> titles;
  for (const RepeatedNumber::OfRun& run : measured.runs()) titles.push_back(run.title);
  const auto numbers = [&](const auto& of_run) {
    std::vector<double> all;
    for (const RepeatedNumber::OfRun& run : measured.runs()) all.push_back(of_run(run));
    return all;
  };
  const std::vector<double> medians =
      numbers([](const RepeatedNumber::OfRun& run) { return Median(run.values); });
  std::string text = measured.text() + ": ";
  bool holds;
  if (of == OrderOf::Medians) {
    holds = IsOrdered(*this, medians);
    text += Listed(titles, medians, measured.unit()) + " (medians of " + Text(n) + ")";
  } else {
    std::size_t ordered = 0, first_that_is_not = n;
    for (std::size_t k = n; k-- > 0;) {
      const bool is = IsOrdered(
          *this, numbers([&](const RepeatedNumber::OfRun& run) { return run.values[k]; }));
      ordered += is;
      if (!is) first_that_is_not = k;
    }
    holds = ordered == n;
    const std::size_t shown = holds ? 0 : first_that_is_not;
    if (n > 1)
      text += "ordered in " + Text(ordered) + " of " + Text(n) + " repetitions; in the first" +
              (holds ? ": " : " that is not: ");
    text +=
        Listed(titles, numbers([&](const RepeatedNumber::OfRun& run) { return run.values[shown]; }),
               measured.unit());
  }
  return claim.Stated(text, CriterionOf(*this, measured.unit(), n > 1), basis, holds);
}

}  // namespace pliant
