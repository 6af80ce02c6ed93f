// What one evaluation of a robot model costs.

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/plants/simbody_arm.h"

namespace pliant {
namespace {

RobotModel Gen3() { return RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf"); }

struct Arm {
  explicit Arm(const std::vector<std::string>& frames = {}) : dynamics(model, frames) {}

  RobotModel model = Gen3();
  RobotDynamics dynamics;
  JointPosition q{0, 0.2618, 3.14, -2.2689, 0.1, 0.9599, 1.57};
  JointVelocity v{0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7};
  JointTorque tau{1, -2, 3, -4, 5, -6, 7};
  PerJoint rotors = PerJoint::Constant(7, 0.3);
};

void BM_DynamicsGen3(benchmark::State& state) {
  const std::vector<std::string> frames{"tool_frame", "forearm_link"};
  Arm arm({frames.begin(), frames.begin() + state.range(0)});
  for (auto _ : state) {
    arm.q(3) += 1e-6;
    ComputeDynamics(arm.model, arm.q, arm.v, arm.dynamics);
    benchmark::DoNotOptimize(arm.dynamics.M.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_DynamicsGen3)->ArgName("frames")->DenseRange(0, 2);

void BM_PointJacobianGen3(benchmark::State& state) {
  Arm arm;
  const int link = arm.model.link_index("forearm_link");
  for (auto _ : state)
    benchmark::DoNotOptimize(PointDynamics(arm.model, arm.dynamics, link, {0, 0, 0.1}));
}
BENCHMARK(BM_PointJacobianGen3);

void BM_ForwardDynamicsGen3Kernel(benchmark::State& state) {
  Arm arm;
  for (auto _ : state) {
    arm.q(3) += 1e-6;
    ComputeDynamics(arm.model, arm.q, arm.v, arm.dynamics);
    benchmark::DoNotOptimize(ForwardDynamics(arm.dynamics, arm.tau, arm.tau, arm.rotors));
  }
}
BENCHMARK(BM_ForwardDynamicsGen3Kernel);

void BM_ForwardDynamicsGen3Simbody(benchmark::State& state) {
  Arm arm;
  const SimbodyArm simbody(arm.model);
  SimbodyArm::Workspace workspace;
  const PerJoint rotors = state.range(0) != 0 ? arm.rotors : PerJoint();
  for (auto _ : state) {
    arm.q(3) += 1e-6;
    benchmark::DoNotOptimize(simbody.ForwardDynamics(arm.q, arm.v, arm.tau, {}, rotors, workspace));
  }
}
BENCHMARK(BM_ForwardDynamicsGen3Simbody)->ArgName("rotors")->DenseRange(0, 1);

void BM_DynamicsGen3SimbodyTwoFrames(benchmark::State& state) {
  Arm arm({"tool_frame", "forearm_link"});
  const SimbodyArm simbody(arm.model);
  SimbodyArm::Workspace workspace;
  for (auto _ : state) {
    arm.q(3) += 1e-6;
    simbody.ComputeDynamics(arm.q, arm.v, arm.dynamics, workspace);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_DynamicsGen3SimbodyTwoFrames);

void BM_ReadGen3(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Gen3());
}
BENCHMARK(BM_ReadGen3)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pliant
