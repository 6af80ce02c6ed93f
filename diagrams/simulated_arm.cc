#include "pliant/diagrams/simulated_arm.h"

namespace pliant {

namespace {

/// The command that is acting: u_k from tick k on. Before the first tick the arm gets nothing.
class Latch final : public Block {
 public:
  struct Options {
    Joints joints;
    Duration period;
  };

  explicit Latch(const Options& o)
      : command{this, "command", o.joints},
        acting{this, "acting", o.joints},
        u_{this, "u", o.joints} {
    Every(o.period).Update(u_).From(command).As([](const JointTorque& u) { return u; });
    Compute(acting).From(u_).As([](const JointTorque& u) { return u; });
  }

  Input<JointTorque> command;
  Output<JointTorque> acting;

 private:
  Discrete<JointTorque> u_;
};

}  // namespace

SimulatedArm::SimulatedArm(const Options& o)
    : torque{this, "torque", o.plant.model.joints()},
      contacts{this, "contacts"},
      measured_position{this, "measured_position", o.plant.model.joints()},
      measured_velocity{this, "measured_velocity", o.plant.model.joints()},
      measured_torque{this, "measured_torque", o.plant.model.joints()},
      position{this, "position", o.plant.model.joints()},
      velocity{this, "velocity", o.plant.model.joints()},
      acceleration{this, "acceleration", o.plant.model.joints()},
      motion{this, "motion", o.plant.model.joints()} {
  const Joints& joints = o.plant.model.joints();
  auto& latch = Add<Latch>("latch", {.joints = joints, .period = o.period});
  auto& plant = Add<SimbodyPlant>("plant", o.plant);
  auto& sensors = Add<JointSensors>("sensors", {.joints = joints, .period = o.period});

  Connect(torque, latch.command);
  Connect(latch.acting, plant.torque);
  Connect(contacts, plant.contacts);
  Connect(plant.position, sensors.position);
  Connect(plant.velocity, sensors.velocity);
  Connect(latch.acting, sensors.torque);

  Connect(sensors.measured_position, measured_position);
  Connect(sensors.measured_velocity, measured_velocity);
  Connect(sensors.measured_torque, measured_torque);
  Connect(plant.position, position);
  Connect(plant.velocity, velocity);
  Connect(plant.acceleration, acceleration);
  Connect(plant.motion, motion);
}

}  // namespace pliant
