#include "pliant/analysis/sample_units.h"

#include <algorithm>
#include <numbers>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTurnPerMinute = 2 * std::numbers::pi / 60;

struct Unit {
  std::string_view name;
  double factor;
};

const std::vector<Unit>& UnitsOf(SampleKind kind) {
  static const std::vector<Unit> of_kind[] = {
      {{"s", 1}, {"ms", 1e-3}, {"µs", 1e-6}, {"us", 1e-6}, {"ns", 1e-9}, {"min", 60}},
      {{"rad", 1}, {"mrad", 1e-3}, {"deg", kDegree}, {"°", kDegree}},
      {{"rad/s", 1},
       {"mrad/s", 1e-3},
       {"deg/s", kDegree},
       {"°/s", kDegree},
       {"rpm", kTurnPerMinute}},
      {{"rad/s²", 1},
       {"rad/s^2", 1},
       {"rad/s2", 1},
       {"deg/s²", kDegree},
       {"deg/s^2", kDegree},
       {"deg/s2", kDegree}},
      {{"A", 1}, {"mA", 1e-3}},
      {{"N·m", 1},
       {"Nm", 1},
       {"N*m", 1},
       {"N.m", 1},
       {"N m", 1},
       {"mN·m", 1e-3},
       {"mNm", 1e-3},
       {"kN·m", 1e3},
       {"kNm", 1e3}}};
  return of_kind[static_cast<std::size_t>(kind)];
}

}  // namespace

std::string_view NameOf(SampleKind kind) {
  static constexpr std::string_view kNames[] = {"time",         "position", "velocity",
                                                "acceleration", "current",  "torque"};
  return kNames[static_cast<std::size_t>(kind)];
}

double UnitFactor(SampleKind kind, std::string_view unit) {
  const std::vector<Unit>& known = UnitsOf(kind);
  if (unit.empty()) return 1;
  if (unit.starts_with('-')) return -UnitFactor(kind, unit.substr(1));
  const auto at = std::ranges::find(known, unit, &Unit::name);
  if (at != known.end()) return at->factor;
  std::string names;
  for (const Unit& u : known) names += (names.empty() ? "" : ", ") + std::string(u.name);
  throw Error("'" + std::string(unit) + "' is no unit of a " + std::string(NameOf(kind)) +
              "; known are " + names);
}

}  // namespace pliant
