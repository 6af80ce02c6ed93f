#include "pliant/diagrams/simulated_arm.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

/// Tick k: (k + 1) N·m on every joint.
class Counter final : public Block {
 public:
  explicit Counter(const Joints& joints) : torque{this, "torque", joints}, k_{this, "k", joints} {
    const PeriodicEvent tick = Every(1ms);
    tick.Compute(torque).From(k_).As(
        [](const JointTorque& k) { return JointTorque(k + PerJoint::Ones(k.size())); });
    tick.Update(k_).From(k_).As(
        [](const JointTorque& k) { return JointTorque(k + PerJoint::Ones(k.size())); });
  }
  Output<JointTorque> torque;

 private:
  Discrete<JointTorque> k_;
};

TEST(SimulatedArm, ShowsAtTickKWhatTheCommandOfTheTickBeforeDid) {
  const RobotModel m = Gen3().WithGravity({0, 0, 0});
  const PerJoint rotors = PerJoint::Constant(7, 1e3);
  DiagramBuilder b;
  auto& command = b.Add<Counter>("command", m.joints());
  auto& arm = b.Add<SimulatedArm>("arm", {.model = m,
                                          .position = JointPosition::Zero(m.joints()),
                                          .actuators = ArmActuators::Ideal(m.joints(), rotors),
                                          .engine = SimbodyPlant::Engine::Recursive});
  b.Connect(command.torque, arm.torque_command);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  RobotDynamics d(m);
  double v = 0;
  for (int k = 0; k < 20; ++k) {
    sim.AdvanceThroughTick();
    EXPECT_EQ(sim.Get(arm.measured_current), PerJoint::Constant(7, k)) << "u of tick k − 1 is k";
    EXPECT_EQ(sim.Get(command.torque), PerJoint::Constant(7, k + 1));
    // Joint 7 moves its link by k N·m for a millisecond: rotors outweigh the coupling 10⁵ times.
    const double inertia = d.M(6, 6) + 1e3;
    const double of_link = d.M.row(6).sum() * k / 1e3;  // all joints speed up by k/10³ rad/s²
    EXPECT_NEAR(sim.Get(arm.measured_torque)(6), of_link, 0.01 * of_link)
        << "a sensor between rotor and link";
    v += k * 1e-3 / inertia;
    EXPECT_NEAR(sim.Get(arm.measured_velocity)(6), v, 1e-3 * v + 1e-12) << k;
  }
}

TEST(SimulatedArm, AcceleratesByTheNewCommandFromItsTickOn) {
  const RobotModel m = Gen3();
  DiagramBuilder b;
  auto& command = b.Add<Counter>("command", m.joints());
  auto& arm = b.Add<SimulatedArm>("arm", {.model = m,
                                          .position = JointPosition::Zero(m.joints()),
                                          .engine = SimbodyPlant::Engine::Recursive});
  b.Connect(command.torque, arm.torque_command);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  for (int k = 0; k < 5; ++k) {
    sim.AdvanceThroughTick();
    RobotDynamics d(m);
    ComputeDynamics(m, sim.Get(arm.position), sim.Get(arm.velocity), d);
    const JointTorque acting = PerJoint::Constant(7, k + 1);
    EXPECT_LT(RelativeError(sim.Get(arm.acceleration),
                            ForwardDynamics(d, acting, JointTorque::Zero(m.joints()))),
              1e-12);
    EXPECT_EQ(sim.Get(arm.measured_position), sim.Get(arm.position));
  }
}

}  // namespace
}  // namespace pliant
