#include "pliant/plants/joint_sensors.h"

namespace pliant {

JointSensors::JointSensors(const Options& o)
    : position{this, "position", o.joints},
      velocity{this, "velocity", o.joints},
      torque{this, "torque", o.joints},
      measured_position{this, "measured_position", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      measured_torque{this, "measured_torque", o.joints} {
  const PeriodicEvent tick = Every(o.period);
  tick.Compute(measured_position).From(position).As([](const JointPosition& q) { return q; });
  tick.Compute(measured_velocity).From(velocity).As([](const JointVelocity& v) { return v; });
  tick.Compute(measured_torque).From(torque).As([](const JointTorque& tau) { return tau; });
}

}  // namespace pliant
