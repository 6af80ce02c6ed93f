#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// EC-fig2 … 4: velocity over position of one joint, a curve for each run. Shaded is what the
/// dampers of the runs forbid: beyond q⁺ − d_s, q⁻ + d_s and ±q̇⁺, and again beyond q⁺ and q⁻.
/// Dashed are these bounds, and where ë_p of EC (24) is zero:
///
///   q̇ = λ/(4M²) (q⁺ − d_s − q)    above,    q̇ = λ/(4M²) (q⁻ + d_s − q)    below
///
/// beyond which the damper brakes. A bound is drawn if the joint comes nearer to it than the curves
/// are wide.
struct PhaseFigure {
  static constexpr const char* kTag = "Phase";
  std::string name, caption;
  std::vector<std::string> runs = {};
  std::string joint;
  double from_s = 0, to_s = kUnbounded;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("caption", caption);
    f("runs", runs);
    f("joint", joint);
    f("from_s", from_s, "s", kNotNegative);
    f("to_s", to_s, "s", kLimit);
  }
  std::string file() const { return name; }
  /// Throws Error if its name cannot name a file, or no row of a run is shown.
  void RequireFit(const Scenario& scenario) const;
  /// Throws Error if the robot has no such joint.
  void RequireSound(const Recording& recorded) const;
  Figure Draw(const Runs& runs) const;
};

}  // namespace pliant
