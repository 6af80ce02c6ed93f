#include "pliant/analysis/equivalence_claim.h"

#include <algorithm>
#include <cmath>

#include "pliant/analysis/equivalence.h"
#include "pliant/analysis/summary.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

bool IsConstant(const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  return least == most;
}

}  // namespace

void EquivalenceClaim::RequireFit(const Scenario& scenario) const {
  Require(run != to, "a run is compared with itself", run);
  Require((margin > 0) != (margin_part > 0), "margin or margin_part must be > 0, one of them",
          Text(margin) + " and " + Text(margin_part));
  number.RequireFit(scenario);
}

void EquivalenceClaim::RequireRepetitions(int repetitions) const {
  if (repetitions < 2)
    throw Error("one repetition says nothing of how numbers scatter; give --repeat 2 or more");
}

Claim EquivalenceClaim::Judge(const RepeatedNumber& measured) const {
  const RepeatedNumber::OfRun &first = measured[run], &second = measured[to];
  const std::string& unit = measured.unit();
  const bool relative = margin_part > 0;
  const double mean = second.finite() ? Summarize(second.values).mean : NAN;
  const double allowed = relative ? margin_part * std::abs(mean) : margin;
  const std::string criterion =
      "p < " + Text(alpha) + " that the means differ by less than " +
      (relative ? Text(100 * margin_part) + " % of that of " + second.title + ", "
                : std::string()) +
      WithUnit(allowed, unit);
  const std::string how = "two one-sided t tests, Welch; " + basis;
  const auto not_judged = [&](const std::string& why) {
    return claim.Stated(why, criterion, how, false);
  };
  if (const auto why = WhyNotComparable(measured)) return not_judged(*why);
  if (IsConstant(first.values) && IsConstant(second.values))
    return not_judged("cannot be judged: " + measured.text() + " is the same in every repetition");
  if (!(allowed > 0)) return not_judged("cannot be judged: the mean of " + second.title + " is 0");
  const EquivalenceOfMeans test =
      TestEquivalenceOfMeans(first.values, second.values, {.margin = allowed, .alpha = alpha});
  return claim.Stated(measured.text() + ": " + first.title + " " +
                          MeanAndDeviation(first.values, unit) + ", " + second.title + " " +
                          MeanAndDeviation(second.values, unit) + " (mean ± SD of " +
                          Text(measured.repetitions()) + "); difference " +
                          WithUnit(test.difference, unit) + ", " + Text(100 * (1 - 2 * alpha)) +
                          " % " + IntervalText(test.interval, unit) + "; " + PText(test.p),
                      criterion, how, test.equivalent);
}

}  // namespace pliant
