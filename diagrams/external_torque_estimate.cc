#include "pliant/diagrams/external_torque_estimate.h"

#include "pliant/estimators/complementary_fusion.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/estimators/super_twisting_fusion.h"
#include "pliant/estimators/super_twisting_observer.h"
#include "pliant/estimators/wrist_torque.h"
#include "pliant/systems/constant.h"

namespace pliant {

ExternalTorqueEstimate::ExternalTorqueEstimate(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      true_torque{this, "true_torque", o.model.joints(), JointTorque::Zero(o.model.joints())},
      wrench{this, "wrench", {}, Wrench()},
      wrench_valid{this, "wrench_valid", {}, true},
      external_torque{this, "external_torque", o.model.joints()},
      residual{this, "residual", o.model.joints()},
      contact{this, "contact"} {
  using enum TorqueEstimate;
  const Joints& joints = o.model.joints();
  const PerJoint gain = PerJoint::Constant(o.model.size(), o.gain);
  const PerJoint rate = PerJoint::Constant(o.model.size(), o.rate);
  const bool needs_wrist =
      o.estimate == Fusion || o.estimate == SuperTwistingFusion || o.estimate == Sensor;
  Require(!needs_wrist || o.wrist,
          "estimate " + WordOf(o.estimate) +
              " needs a wrist sensor; expected a robot that has one, such as "
              "gen3_bota, or the estimate observer");

  WristTorque* wrist = nullptr;
  if (o.wrist) {
    auto& tool = Add<ToolCompensation>(
        "tool", {.model = o.model, .frame = o.wrist->frame, .tool = o.wrist->tool});
    wrist = &Add<WristTorque>("wrist", {.model = o.model, .frame = o.wrist->frame});
    Connect(wrench, tool.measured);
    Connect(wrench_valid, tool.measured_valid);
    Connect(dynamics, tool.dynamics);
    Connect(tool.contact, wrist->contact);
    Connect(dynamics, wrist->dynamics);
    Connect(tool.contact, contact);
  } else {
    auto& none = Add<Constant<Wrench>>("tool", {.value = Wrench()});
    Connect(none.y, contact);
  }

  const auto observed_by = [&](auto& observer) {
    Connect(dynamics, observer.dynamics);
    Connect(torque, observer.torque);
    Connect(observer.residual, residual);
  };
  switch (o.estimate) {
    case SuperTwisting: {
      auto& observer = Add<SuperTwistingObserver>(
          "observer",
          {.joints = joints, .rate = rate, .period = o.period, .rotor_inertia = o.rotor_inertia});
      observed_by(observer);
      Connect(observer.residual, external_torque);
      return;
    }
    case SuperTwistingFusion: {
      auto& fusion = Add<pliant::SuperTwistingFusion>(
          "fusion",
          {.joints = joints, .rate = rate, .period = o.period, .rotor_inertia = o.rotor_inertia});
      observed_by(fusion);
      Connect(wrist->torque, fusion.sensor_torque);
      Connect(wrench_valid, fusion.sensor_valid);
      Connect(fusion.external_torque, external_torque);
      return;
    }
    default:
      break;
  }
  auto& observer = Add<MomentumObserver>(
      "observer",
      {.joints = joints, .gain = gain, .period = o.period, .rotor_inertia = o.rotor_inertia});
  observed_by(observer);
  if (o.estimate == True) {
    Connect(true_torque, external_torque);
  } else if (o.estimate == Observer) {
    Connect(observer.residual, external_torque);
  } else if (o.estimate == Sensor) {
    Connect(wrist->torque, external_torque);
  } else if (o.estimate == Zero) {
    auto& none =
        Add<Constant<JointTorque>>("none", {.space = joints, .value = JointTorque::Zero(joints)});
    Connect(none.y, external_torque);
  } else {
    auto& fusion =
        Add<ComplementaryFusion>("fusion", {.joints = joints, .gain = gain, .period = o.period});
    Connect(observer.residual, fusion.residual);
    Connect(wrist->torque, fusion.sensor_torque);
    Connect(wrench_valid, fusion.sensor_valid);
    Connect(fusion.external_torque, external_torque);
  }
}

}  // namespace pliant
