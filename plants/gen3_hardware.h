#pragma once

#include <memory>

#include "pliant/plants/gen3_arm.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A Kinova Gen3 behind the ports of a simulated arm (SimulatedArm): a mode and commands in;
/// samples of its sensors out.
///
///   arm ─▶ sample ─▶ measured_… ─▶ controllers ─▶ mode, commands ─▶ arm
///
/// At a tick it takes what has arrived since the last, and when all held outputs of the tick are
/// there it sends the commands. So the sensors of tick k saw the commands of tick k − 1, as in a
/// simulation. It reads and writes the world: a run is not repeated by restoring it; replay a log
/// for that.
class Gen3Hardware final : public Block {
 public:
  struct Options {
    Joints joints;
    JointPosition position;        ///< where the arm is at first [rad]
    std::shared_ptr<Gen3Arm> arm;  ///< null: a diagram to draw or to replay
    Duration period = 1ms;
  };

  explicit Gen3Hardware(const Options& o);

  Input<ControlMode> mode;
  Input<JointPosition> position_command;
  Input<JointTorque> torque_command;
  Input<MotorCurrent> current_command;

  Output<JointPosition> measured_position;
  Output<JointVelocity> measured_velocity;
  Output<JointTorque> measured_torque;
  Output<MotorCurrent> measured_current;
  Output<JointTemperature> temperature;
  Output<ArmStatus> status;
  Output<Gen3Report> report;

 private:
  Gen3Sample Receive(const Gen3Sample& last) const { return arm_ ? arm_->Latest() : last; }
  void Send(const ControlMode& mode, const JointPosition& q_d, const JointTorque& tau_d,
            const MotorCurrent& i_d) const;

  const std::shared_ptr<Gen3Arm> arm_;
  Output<Gen3Sample> sample_;
};

}  // namespace pliant
