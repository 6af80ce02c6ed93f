#include "pliant/analysis/least_claim.h"

#include <algorithm>

#include "pliant/analysis/with_unit.h"

namespace pliant {

void LeastClaim::RequireFit(const Scenario& scenario) const {
  Require(!others.empty(), "it compares with no other run");
  Require(std::ranges::find(others, run) == others.end(),
          "a run cannot be compared with itself, '" + run + "'");
  number.RequireFit(scenario);
}

Claim LeastClaim::Check(const Runs& runs) const {
  const RecordedSignal& recorded = runs[run].log[number.signal];
  const std::string unit = number.unit(recorded);
  const double least = number.Of(runs[run].log);
  std::string measured =
      number.text(recorded) + ": " + runs[run].title + " " + WithUnit(least, unit);
  bool holds = true;
  for (const std::string& other : others) {
    const double value = number.Of(runs[other].log);
    measured += "; " + runs[other].title + " " + WithUnit(value, unit);
    holds = holds && least <= value && factor * least <= value;
  }
  return claim.Stated(measured,
                      factor == 1 ? "at most each of the others"
                                  : Text(factor) + " times it is at most each of the others",
                      basis, holds);
}

}  // namespace pliant
