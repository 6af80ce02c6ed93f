#include "pliant/diagrams/law_diagram.h"

#include <initializer_list>
#include <string>
#include <utility>

#include "pliant/diagrams/scenario_environment.h"
#include "pliant/diagrams/without_weight.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/constant.h"

namespace pliant {

TorqueLaw::TorqueLaw(const Options& o)
    : measured_position{this, "measured_position", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      measured_torque{this, "measured_torque", o.joints},
      torque{this, "torque", o.joints},
      joints_{o.joints},
      function_{o.function} {
  Require(function_ != nullptr, "function must be given");
  Every(o.period)
      .Compute(torque)
      .From(clock, measured_position, measured_velocity, measured_torque)
      .As(&TorqueLaw::Call);
}

JointTorque TorqueLaw::Call(double t, const JointPosition& q, const JointVelocity& v,
                            const JointTorque& tau) const {
  const JointTorque torque = function_(t, q, v, tau);
  Require(torque.size() == joints_.size(),
          "a law gives a torque for each of " + joints_.text() + " [N·m]", torque.size());
  return torque;
}

LawDiagram::LawDiagram(const Scenario& scenario, TorqueLaw::Function law,
                       std::shared_ptr<RecordSink> sink) {
  Require(!IsHardware(scenario),
          "station !Gen3 is an arm that is there, and a function commands simulated ones: expected "
          "station: !SimulatedArm {}");
  const SimulatedArm::Options station = StationOf(scenario);
  const RobotModel& model = station.model;
  const Joints& joints = model.joints();
  control_period = ControlPeriodOf(scenario);

  DiagramBuilder& b = builder;
  auto& link_motion = b.Add<ModelDynamics>("link_motion", {.model = model});
  auto& true_torque = b.Add<ContactTorque>("true_torque", {.model = model});
  arm = &b.Add<SimulatedArm>("arm", station);
  internal::Environment environment(b, *arm, true_torque, model, control_period);
  for (const EnvironmentPart& part : scenario.environment) std::visit(environment, part);
  auto& load =
      b.Add<Constant<JointTorque>>("load", {.space = joints, .value = JointTorque::Zero(joints)});
  control = &b.Add<TorqueLaw>(
      "control", {.joints = joints, .function = std::move(law), .period = control_period});
  auto& mode = b.Add<Constant<ControlMode>>("mode", {.value = ControlMode::Torque});

  b.Connect(arm->measured_position, link_motion.position);
  b.Connect(arm->measured_velocity, link_motion.velocity);
  b.Connect(link_motion.dynamics, true_torque.dynamics);
  b.Connect(arm->measured_position, control->measured_position);
  b.Connect(arm->measured_velocity, control->measured_velocity);
  b.Connect(arm->measured_torque, control->measured_torque);
  b.Connect(load.y, arm->loads);
  b.Connect(mode.y, arm->mode);
  if (station.firmware.compensated) {
    auto& carried = b.Add<internal::WithoutWeight>("carried", joints);
    b.Connect(control->torque, carried.torque);
    b.Connect(link_motion.dynamics, carried.dynamics);
    b.Connect(carried.command, arm->torque_command);
  } else {
    b.Connect(control->torque, arm->torque_command);
  }

  const std::vector<AnyInputs*> watching =
      internal::AddWatchers(b, scenario, control_period, std::move(sink));
  for (AnyInputs* in : watching) {
    for (const internal::Value* value : environment.recorded) b.Connect(*value, *in);
    for (const internal::Value* value : std::initializer_list<const internal::Value*>{
             &arm->measured_position, &arm->measured_velocity, &arm->measured_torque,
             &arm->measured_current, &arm->wrench, &arm->wrench_valid, &arm->status, &arm->position,
             &arm->velocity, &arm->joint_torque, &arm->energy, &true_torque.torque,
             &control->torque})
      b.Connect(*value, *in);
  }
}

}  // namespace pliant
