#include "pliant/diagrams/sway_loop.h"

#include "pliant/diagrams/stations.h"
#include "pliant/plants/model_dynamics.h"

namespace pliant {

JointAcceleration SwayAcceleration(double t, const JointPosition& rest, const RobotDynamics& d) {
  const PerJoint phase = PerJoint::LinSpaced(rest.size(), 0, 3).array() + 2 * t;
  const PerJoint q = rest.array() + 0.1 * phase.array().sin();
  const PerJoint v = 0.2 * phase.array().cos();
  const PerJoint a = -0.4 * phase.array().sin();
  return a + 40 * (v - d.v) + 400 * (q - d.q);
}

SwayLaw::SwayLaw(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      acceleration{this, "acceleration", o.joints},
      torque{this, "torque", o.joints},
      rest_{o.rest} {
  if (o.period == Duration{}) {
    Compute(acceleration).From(clock, dynamics).As(&SwayLaw::Want);
  } else {
    Every(o.period).Compute(acceleration).From(clock, dynamics).As(&SwayLaw::Want);
  }
  Compute(torque).From(dynamics, acceleration).As(&InverseDynamics);
}

SwayLoop::SwayLoop(const Options& o) : diagram{Make(o, *this)} {}

Diagram SwayLoop::Make(const Options& o, SwayLoop& parts) {
  const RobotModel& model = o.arm.model;
  DiagramBuilder b;
  auto& arm = b.Add<SimulatedArm>("arm", o.arm);
  auto& dynamics = b.Add<ModelDynamics>(
      "dynamics", {.model = model, .rotor_inertia = o.arm.actuators.reflected_inertia()});
  auto& law = b.Add<SwayLaw>(
      "law", {.joints = model.joints(), .rest = o.arm.position, .period = o.arm.period});
  b.Connect(arm.measured_position, dynamics.position);
  b.Connect(arm.measured_velocity, dynamics.velocity);
  b.Connect(dynamics.dynamics, law.dynamics);
  if (o.arm.firmware.mode == ControlMode::Current) {
    auto& low_level =
        b.Add<LowLevelTorque>("low_level", LowLevelTorqueOf(o.arm.actuators, model, o.arm.period));
    b.Connect(law.torque, low_level.torque);
    b.Connect(law.acceleration, low_level.acceleration);
    b.Connect(arm.measured_velocity, low_level.measured_velocity);
    b.Connect(arm.measured_torque, low_level.measured_torque);
    b.Connect(low_level.current, arm.current_command);
  } else {
    b.Connect(law.torque, arm.torque_command);
  }
  if (o.account) {
    auto& work = b.Add<Integral<double>>("work", {});
    auto& heat = b.Add<Integral<double>>("heat", {});
    b.Connect(arm.power, work.u);
    b.Connect(arm.dissipation, heat.u);
    parts.work = &work;
    parts.heat = &heat;
  }
  parts.arm = &arm;
  return b.Build();
}

SmoothSwayLoop::SmoothSwayLoop(const SimbodyPlant::Options& o) : diagram{Make(o, *this)} {}

Diagram SmoothSwayLoop::Make(const SimbodyPlant::Options& o, SmoothSwayLoop& parts) {
  DiagramBuilder b;
  auto& arm = b.Add<SimbodyPlant>("arm", o);
  auto& dynamics =
      b.Add<ModelDynamics>("dynamics", {.model = o.model, .rotor_inertia = o.rotor_inertia});
  auto& law = b.Add<SwayLaw>("law", {.joints = o.model.joints(), .rest = o.position});
  b.Connect(arm.position, dynamics.position);
  b.Connect(arm.velocity, dynamics.velocity);
  b.Connect(dynamics.dynamics, law.dynamics);
  b.Connect(law.torque, arm.torque);
  parts.arm = &arm;
  return b.Build();
}

}  // namespace pliant
