#include "pliant/systems/parameter.h"

namespace pliant {

std::string Range::text() const {
  const bool from = least > kAnyNumber.least, to = most < kAnyNumber.most;
  if (from && to)
    return (without_least ? "above " : "from ") + Text(least) +
           (without_most ? " to below " : " to ") + Text(most);
  if (from) return (without_least ? "> " : ">= ") + Text(least);
  if (to) return "<= " + Text(most);
  return "finite";
}

void RequireInRange(std::string_view where, std::string_view name, double value,
                    std::string_view unit, const Range& range) {
  if (range.Contains(value)) return;
  const std::string in_unit = unit.empty() ? "" : " " + std::string(unit);
  throw Error((where.empty() ? "" : std::string(where) + ": ") + std::string(name) + " must be " +
              range.text() + in_unit + ", got " + Text(value));
}

void RequireOneForEach(const Space& joints, std::string_view name, std::ptrdiff_t found) {
  Require(found == joints.size(),
          std::string(name) + " has an element for each of the " + Text(joints.size()) + " joints",
          found);
}

}  // namespace pliant
