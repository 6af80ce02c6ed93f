// What a tick of null-space compliance costs, through the framework: measurements in, torque out.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pliant/diagrams/null_space_control.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

/// An LWR that sways by 0.1 rad at 1 Hz, with a choice for its null space.
void Tick(benchmark::State& state, const NullSpaceChoice& null_space) {
  const RobotModel m = RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/lwr/lwr4p.urdf");
  const JointPosition start{0, 0.7, 0, -1.57, 0, 0.87, 0};
  DiagramBuilder b;
  auto& q = b.Add<Constant<JointPosition>>("q", {.space = m.joints(), .value = start});
  auto& v = b.Add<Constant<JointVelocity>>(
      "v", {.space = m.joints(), .value = JointVelocity::Zero(m.joints())});
  auto& tau = b.Add<Constant<JointTorque>>(
      "tau", {.space = m.joints(), .value = JointTorque::Zero(m.joints())});
  NullSpaceControl::Options o;
  o.model = m;
  o.position = start;
  o.rotor_inertia = PerJoint::Constant(m.size(), 0.5);
  o.coulomb = PerJoint::Constant(m.size(), 0.3);
  o.period = 5ms;
  o.tool = "end_effector_link";
  o.motion = CircleGenerator::Options{
      .radius = 0.1, .angular_velocity = 0.5, .radial_gain = 2, .height_gain = 10};
  o.null_space = null_space;
  auto& control = b.Add<NullSpaceControl>("control", o);
  b.Connect(q.y, control.measured_position);
  b.Connect(v.y, control.measured_velocity);
  b.Connect(tau.y, control.measured_torque);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  const PerJoint phase = PerJoint::LinSpaced(m.size(), 0, 3);
  constexpr double w = 2 * std::numbers::pi;
  int k = 0;
  for (auto _ : state) {
    const PerJoint angle = phase.array() + w * 5e-3 * ++k;
    sim.Set(q.value, start + 0.1 * PerJoint(angle.array().sin()));
    sim.Set(v.value, 0.1 * w * PerJoint(angle.array().cos()));
    sim.AdvanceThroughTick();
    benchmark::DoNotOptimize(sim.Get(control.torque).data());
  }
}
BENCHMARK_CAPTURE(Tick, Printed, PrintedNullSpaceTorque{})->Name("NullSpaceTick/Printed");
BENCHMARK_CAPTURE(Tick, Meant, MeantNullSpaceTorque{})->Name("NullSpaceTick/Meant");
BENCHMARK_CAPTURE(Tick, Observer, ObservedNullSpaceTorque{})->Name("NullSpaceTick/Observer");
BENCHMARK_CAPTURE(Tick, LeastSquares, RegressedNullSpaceTorque{})
    ->Name("NullSpaceTick/LeastSquares");

}  // namespace
}  // namespace pliant
