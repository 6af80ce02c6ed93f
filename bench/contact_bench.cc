// What a tick of contact control costs, through the framework: measurements in, torque out.

#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/diagrams/contact_control.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

/// An LWR that sways by 0.1 rad at 1 Hz, touched on so many links.
void Tick(benchmark::State& state, const ContactBehavior& behavior) {
  const RobotModel m = RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/lwr/lwr4p.urdf");
  const JointPosition start{0, 0.7, 0, -1.57, 0, 0.87, 0};
  DiagramBuilder b;
  auto& q = b.Add<Constant<JointPosition>>("q", {.space = m.joints(), .value = start});
  auto& v = b.Add<Constant<JointVelocity>>(
      "v", {.space = m.joints(), .value = JointVelocity::Zero(m.joints())});
  // Without the arm's weight there is a residual, so it counts as touched.
  auto& tau = b.Add<Constant<JointTorque>>(
      "tau", {.space = m.joints(), .value = JointTorque::Zero(m.joints())});
  ContactControl::Options o;
  o.model = m;
  o.position = start;
  o.rotor_inertia = PerJoint::Constant(m.size(), 0.5);
  o.period = 5ms;
  o.tool = "end_effector_link";
  o.contact.behavior = behavior;
  o.contact.tare_until_s = 0;
  auto& control = b.Add<ContactControl>("control", o);
  const std::vector<std::string> links{"link_6", "link_4", "link_3"};
  for (int i = 0; i < state.range(0); ++i) {
    const std::string& link = links[static_cast<std::size_t>(i)];
    auto& touch = b.Add<Constant<ContactForce>>(
        "touch_" + link,
        {.value = {m.link_index(link), {0, 0, 0.1}, {0, 20, 0}, Eigen::Vector3d::Zero()}});
    b.Connect(touch.y, control.contacts);
  }
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
  if (sim.Get(control.report).rows != 3 * state.range(0))
    state.SkipWithError("the arm is not touched where it should be");
}
BENCHMARK_CAPTURE(Tick, Impedance, ContactImpedance::Gains{})
    ->Name("ContactTick/Impedance")
    ->ArgName("contacts")
    ->DenseRange(0, 3);
BENCHMARK_CAPTURE(Tick, Force, ContactForceControl::Settings{})
    ->Name("ContactTick/Force")
    ->ArgName("contacts")
    ->DenseRange(1, 1);

}  // namespace
}  // namespace pliant
