#include "pliant/systems/parameter.h"

namespace pliant {

std::string Range::text() const {
  const bool from = least > kAnyNumber.least, to = most < kAnyNumber.most;
  if (from && to) return (without_least ? "above " : "from ") + Text(least) + " to " + Text(most);
  if (from) return (without_least ? "> " : ">= ") + Text(least);
  if (to) return "<= " + Text(most);
  return "a finite number";
}

void RequireInRange(std::string_view where, std::string_view name, double value,
                    std::string_view unit, const Range& range) {
  if (range.Contains(value)) return;
  const std::string in_unit = unit.empty() ? "" : " " + std::string(unit);
  throw Error((where.empty() ? "" : std::string(where) + ": ") + std::string(name) + " must be " +
              range.text() + in_unit + ", got " + Text(value));
}

void RequireInRange(const Joints& joints, std::string_view name, const PerJoint& values,
                    std::string_view unit, const Range& range) {
  Require(values.size() == joints.size(),
          std::string(name) + " has an element for each of the " + Text(joints.size()) + " joints",
          values.size());
  for (int j = 0; j < joints.size(); ++j) RequireInRange(joints[j], name, values(j), unit, range);
}

}  // namespace pliant
