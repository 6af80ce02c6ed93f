#include "pliant/analysis/bound_claim.h"

#include <cmath>

#include "pliant/analysis/with_unit.h"

namespace pliant {

void BoundClaim::RequireFit(const Scenario& scenario) const {
  Require(std::isfinite(least) || std::isfinite(most), "least or most must be given");
  Require(least <= most, "least must be <= most", Text(least) + " and " + Text(most));
  number.RequireFit(scenario);
}

void BoundClaim::RequireSound(const RecordedSignal& recorded) const {
  number.RequireSound(recorded);
  Require(!number.is_norm(recorded) || most >= 0, "most of a norm must be >= 0", most);
}

Claim BoundClaim::Check(const Runs& runs) const {
  const RecordedSignal& recorded = runs[run].log[number.signal];
  const std::string unit = number.unit(recorded);
  const double value = number.Of(runs[run].log);
  std::string criterion;
  if (std::isfinite(least)) criterion = "at least " + WithUnit(least, unit);
  if (std::isfinite(most))
    criterion += (criterion.empty() ? "at most " : ", at most ") + WithUnit(most, unit);
  return claim.Stated(number.text(recorded) + " is " + WithUnit(value, unit), criterion, basis,
                      value >= least && value <= most);
}

}  // namespace pliant
