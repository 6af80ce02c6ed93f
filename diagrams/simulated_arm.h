#pragma once

#include <string>
#include <vector>

#include "pliant/plants/joint_sensors.h"
#include "pliant/plants/push.h"
#include "pliant/plants/simbody_plant.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// A simulated arm with ideal torque actuators and ideal sensors, as a controller sees it: torque
/// command in, samples of what the joints do out, every h.
///
///   torque ─▶ latch ─▶ plant ─▶ sensors ─▶ measured_…
///                        ▲
///   contacts ────────────┘
///
/// The command of tick k acts from tick k to tick k + 1, so the sensors of tick k see u_{k−1}.
class SimulatedArm final : public Composite {
 public:
  struct Options {
    SimbodyPlant::Options plant;
    Duration period = 1ms;
  };

  explicit SimulatedArm(const Options& o);

  Input<JointTorque> torque;
  InputList<ContactForce> contacts;

  Output<JointPosition> measured_position;
  Output<JointVelocity> measured_velocity;
  Output<JointTorque> measured_torque;

  Output<JointPosition> position;  ///< what the plant does, not what sensors say of it
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;
  Output<RobotDynamics> motion;
};

}  // namespace pliant
