#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/diagrams/hardware_arm.h"
#include "pliant/diagrams/stations.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

// shown: begin
/// A damper on any station that has an arm's ports.
template <class Station>
Diagram MakeDampedArm(const typename Station::Options& options) {
  const Joints joints = options.model.joints();
  DiagramBuilder b;
  auto& arm = b.Add<Station>("arm", options);
  auto& damper = b.Add<Gain<JointVelocity, JointTorque>>("damper", {.space = joints, .gain = -5});
  auto& mode = b.Add<Constant<ControlMode>>("mode", {.value = ControlMode::Torque});
  auto& position =
      b.Add<Constant<JointPosition>>("position", {.space = joints, .value = options.position});
  auto& current = b.Add<Constant<MotorCurrent>>(
      "current", {.space = joints, .value = MotorCurrent::Zero(joints)});
  b.Connect(arm.measured_velocity, damper.u);
  b.Connect(damper.y, arm.torque_command);
  b.Connect(mode.y, arm.mode);
  b.Connect(position.y, arm.position_command);
  b.Connect(current.y, arm.current_command);
  return b.Build();
}

TEST(Stations, HaveTheSamePortsSimulatedAndThere) {
  const RobotModel gen3 = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  const JointPosition home{0, 0.26, 3.14, -2.27, 0, 0.96, 1.57};

  const Diagram simulated = MakeDampedArm<SimulatedArm>(SimulatedGen3(gen3, {.position = home}));
  const Diagram there = MakeDampedArm<HardwareArm>({.model = gen3, .position = home});

  const auto has = [](const Diagram& diagram, const std::string& path) {
    const std::vector<ValueInfo> values = diagram.Values();
    return std::ranges::find(values, path, &ValueInfo::path) != values.end();
  };
  for (const std::string port :
       {"torque_command", "measured_position", "measured_torque", "status"})
    EXPECT_TRUE(has(simulated, "arm." + port) && has(there, "arm." + port)) << port;
}
// shown: end

}  // namespace
}  // namespace pliant
