#include "pliant/analysis/sample.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pliant/systems/error.h"

namespace pliant::internal {

void RequireSample(const std::vector<double>& values, std::string_view sample, std::size_t least) {
  const std::string name(sample);
  Require(values.size() >= least,
          name + " must have at least " + (least == 1 ? "one value" : Text(least) + " values"),
          values.size());
  const auto wrong =
      std::ranges::find_if(values, [](double v) { return !(std::abs(v) <= kLargestOfSample); });
  if (wrong == values.end()) return;
  const std::string where = name + ": value " + Text(wrong - values.begin() + 1);
  Require(std::isfinite(*wrong), where + " must be finite: leave out what was not measured",
          *wrong);
  Require(false, where + " must lie within ±1e75: choose another unit", *wrong);
}

}  // namespace pliant::internal
