#pragma once

#include <string>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// RSS, fig. 3: the torque that friction takes, y = κ i − τ − B q̈, over the velocity, without the
/// offset of the sensor; the Coulomb and viscous friction that fits all joints of an actuator size,
/// and the torque up to which they stay at rest. A panel for each size.
struct FrictionFigure {
  static constexpr const char* kTag = "Friction";
  std::string name = "friction";
  std::string run;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("run", run);
  }
  std::string file() const { return name; }
  /// Throws Error if its run is no friction experiment.
  void RequireFit(const Scenario& scenario) const;
  Figure Draw(const Runs& runs) const;
};

}  // namespace pliant
