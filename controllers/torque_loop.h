#pragma once

#include "pliant/plants/arm_status.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// What makes currents of the torques that are wanted of geared motors. One can stand in the place
/// of another.
class TorqueLoop : public Composite {
 public:
  Input<JointTorque> torque;              ///< τ_d = M q̈_d + C q̇ + g − τ̂_e + B q̈_d
  Input<JointAcceleration> acceleration;  ///< q̈_d
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;  ///< τ, behind the gears
  Output<MotorCurrent> current;        ///< i
  Output<JointTorque> error;           ///< e = τ_d − B q̈_d − τ
  Output<JointBits> saturated;         ///< joints whose current is cut

 protected:
  explicit TorqueLoop(const Joints& joints)
      : torque{this, "torque", joints},
        acceleration{this, "acceleration", joints},
        measured_velocity{this, "measured_velocity", joints},
        measured_torque{this, "measured_torque", joints},
        current{this, "current", joints},
        error{this, "error", joints},
        saturated{this, "saturated"} {}
};

}  // namespace pliant
