#include "pliant/analysis/difference_claim.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "pliant/analysis/mann_whitney.h"
#include "pliant/analysis/shapiro_wilk.h"
#include "pliant/analysis/summary.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

std::string Digits(const char* format, double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// "W = 0.97, p = 0.5", where it can be said.
std::string Normality(const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  if (values.size() < 3 || values.size() > 5000 || least == most) return "cannot be said";
  const ShapiroWilk test = ShapiroWilkTest(values);
  return "W = " + Digits("%.3f", test.w) + ", " + PText(test.p);
}

/// The smallest two-sided p of two groups of n values, 2 / (2n over n).
double LeastP(int n) {
  double p = 2;
  for (int k = 1; k <= n; ++k) p *= static_cast<double>(k) / (n + k);
  return p;
}

const char* How(NullDistribution distribution) {
  switch (distribution) {
    case NullDistribution::kExact:
      return "exact";
    case NullDistribution::kExactWithTies:
      return "exact with ties";
    case NullDistribution::kNormal:
      return "by the normal approximation";
  }
  return "";
}

}  // namespace

void DifferenceClaim::RequireFit(const Scenario& scenario) const {
  Require(run != than, "a run is compared with itself", run);
  number.RequireFit(scenario);
}

void DifferenceClaim::RequireRepetitions(int repetitions) const {
  if (LeastP(repetitions) < alpha) return;
  int enough = repetitions;
  while (LeastP(enough) >= alpha) ++enough;
  throw Error("p of " + Text(repetitions) + (repetitions == 1 ? " repetition" : " repetitions") +
              " is never below " + Digits("%.2g", LeastP(repetitions)) + ", and alpha is " +
              Text(alpha) + "; give --repeat " + Text(enough) + " or more");
}

Claim DifferenceClaim::Judge(const RepeatedNumber& measured) const {
  const RepeatedNumber::OfRun &first = measured[run], &second = measured[than];
  const std::string& unit = measured.unit();
  const bool less = direction == DifferenceDirection::Less;
  const std::string criterion = "two-sided p < " + Text(alpha) + ", and " + first.title + " is " +
                                WordOf(direction) + " (r " + (less ? "<" : ">") + " 0)";
  const std::string basis =
      "Mann–Whitney U test over all repetitions, rank-biserial r as effect size; α stated "
      "beforehand";
  if (const auto why = WhyNotComparable(measured))
    return claim.Stated(*why, criterion, basis, false);
  const MannWhitney test = MannWhitneyTest(first.values, second.values);
  const double difference = Summarize(first.values).mean - Summarize(second.values).mean;
  const std::optional<Interval> interval = IntervalOfDifference(first.values, second.values);
  const std::string text =
      measured.text() + ": " + first.title + " " + MeanAndDeviation(first.values, unit) + ", " +
      second.title + " " + MeanAndDeviation(second.values, unit) + " (mean ± SD of " +
      Text(measured.repetitions()) + "); difference " + WithUnit(difference, unit) +
      (interval ? ", 95 % " + IntervalText(*interval, unit) : "") +
      "; U = " + Digits("%g", test.u) + ", " + PText(test.p_two_sided) + " (" +
      How(test.distribution) + "), r = " + Digits("%.2f", test.rank_biserial) +
      "; Shapiro–Wilk: " + Normality(first.values) + " and " + Normality(second.values);
  return claim.Stated(
      text, criterion, basis,
      test.p_two_sided < alpha && (less ? test.rank_biserial < 0 : test.rank_biserial > 0));
}

}  // namespace pliant
