#pragma once

#include <string>

#include "pliant/controllers/friction_excitation.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// Excites the friction of one joint after the other, in motor currents, with the ports of any
/// controller of an arm.
///
///   measured_… ─▶ dynamics ─▶ excitation ─▶ current
///              ─────────────▶     └──▶ torque, report
///
/// Source: Muraccioli et al. 2025 (RSS), friction identification.
class FrictionExperiment final : public Composite {
 public:
  struct Options {
    static constexpr const char* kTag = "FrictionExperiment";

    RobotModel model;            ///< the controller's
    JointPosition position;      ///< at the start, and between tests
    PerJoint rotor_inertia;      ///< B, reflected [kg·m²]
    Duration period = 1ms;       ///< of the arm's interface
    PerJoint torque_per_ampere;  ///< κ [N·m/A]
    PerJoint coulomb;            ///< ĉ, assumed [N·m]
    PerJoint viscous;            ///< d̂, assumed [N·m·s/rad]
    std::string tool;            ///< link whose motion is of interest
    FrictionTest test = {};

    template <class F>
    void Parameters(F&& f) {
      test.Parameters(f);
    }
  };

  explicit FrictionExperiment(const Options& o);

  /// How long it takes if the friction is as assumed [s].
  static double LengthOf(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Input<JointTemperature> temperature;  ///< 0 if not connected
  Output<MotorCurrent> current;
  Output<JointTorque> torque;       ///< that the motors are to make, κ i
  Output<JointPosition> reference;  ///< where the joints are to be
  Output<JointTorque> break_away_up, break_away_down;
  Output<FrictionReport> report;
};

}  // namespace pliant
