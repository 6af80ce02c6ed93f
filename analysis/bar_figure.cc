#include "pliant/analysis/bar_figure.h"

#include <algorithm>
#include <cmath>

#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/mann_whitney.h"
#include "pliant/analysis/summary.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

std::string Stars(double p) { return p < 0.001 ? "**" : p < 0.05 ? "*" : "n.s."; }

/// Of what stands beside the bars: one for all, by the largest.
ScaledUnit UnitOf(const RepeatedNumber& number) {
  double largest = 0;
  for (const RepeatedNumber::OfRun& run : number.runs())
    if (run.finite()) largest = std::max(largest, std::abs(Summarize(run.values).mean));
  return UnitFor(largest, number.unit());
}

/// Runs of one title are told apart by their names.
std::string LabelOf(const RepeatedNumber& number, const RepeatedNumber::OfRun& run) {
  const bool alone =
      std::ranges::count(number.runs(), run.title, &RepeatedNumber::OfRun::title) == 1;
  return alone ? run.title : run.title + " (" + run.run + ")";
}

Bar BarOf(const RepeatedNumber& number, const RepeatedNumber::OfRun& run, double factor) {
  Bar bar{.group = "", .label = LabelOf(number, run), .mean = NAN};
  if (!run.finite()) return bar;
  const Summary s = Summarize(run.values);
  bar.mean = s.mean / factor;
  bar.deviation = s.standard_deviation / factor;
  return bar;
}

}  // namespace

void BarFigure::RequireFit(const Scenario& scenario) const {
  RequireFileName(name);
  Require(!numbers.empty(), "it shows no number");
  for (const Shown& shown : numbers) shown.number.RequireFit(scenario);
}

void BarFigure::RequireSound(const Recording& recorded) const {
  for (const Shown& shown : numbers) shown.number.RequireSound(recorded[shown.number.signal]);
}

std::vector<RepeatedNumber> BarFigure::Wanted() const {
  std::vector<RepeatedNumber> all;
  for (const Shown& shown : numbers) all.emplace_back(shown.number, runs);
  return all;
}

Figure BarFigure::Draw(const std::vector<RepeatedNumber>& measured) const {
  Figure figure{.name = name, .caption = caption, .columns = static_cast<int>(numbers.size())};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const RepeatedNumber& number = measured[i];
    const std::vector<RepeatedNumber::OfRun>& of = number.runs();
    const ScaledUnit unit = UnitOf(number);
    Panel panel{.title = numbers[i].title + (unit.unit.empty() ? "" : " [" + unit.unit + "]")};
    for (const RepeatedNumber::OfRun& run : of)
      panel.bars.push_back(BarOf(number, run, unit.factor));
    for (std::size_t a = 0; brackets && number.repetitions() > 1 && a < of.size(); ++a)
      for (std::size_t b = a + 1; b < of.size(); ++b)
        if (of[a].finite() && of[b].finite())
          panel.brackets.push_back(
              {.from = a,
               .to = b,
               .label = Stars(MannWhitneyTest(of[a].values, of[b].values).p_two_sided)});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace pliant
