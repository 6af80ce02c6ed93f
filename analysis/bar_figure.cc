#include "pliant/analysis/bar_figure.h"

#include "pliant/analysis/experiment_figures.h"
#include "pliant/analysis/mann_whitney.h"
#include "pliant/analysis/summary.h"

namespace pliant {

namespace {

std::string Stars(double p) { return p < 0.001 ? "**" : p < 0.05 ? "*" : "n.s."; }

Bar BarOf(const RepeatedNumber::OfRun& run) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!run.finite()) return {.group = "", .label = run.title, .mean = kNone};
  const Summary s = Summarize(run.values);
  return {.group = "", .label = run.title, .mean = s.mean, .deviation = s.standard_deviation};
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
    Panel panel{.title = numbers[i].title,
                .left = {.label = number.unit().empty() ? "" : "[" + number.unit() + "]"}};
    for (const RepeatedNumber::OfRun& run : of) panel.bars.push_back(BarOf(run));
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
