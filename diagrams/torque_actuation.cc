#include "pliant/diagrams/torque_actuation.h"

#include <type_traits>
#include <variant>

#include "pliant/controllers/torque_error.h"
#include "pliant/systems/constant.h"

namespace pliant {

namespace {

PerJoint RotorsOf(const TorqueActuation::Options& o) {
  return o.rotor_inertia.size() > 0 ? o.rotor_inertia : PerJoint(PerJoint::Zero(o.joints.size()));
}

/// The block of options: the class they are nested in.
template <class Options>
struct BlockOf;
template <>
struct BlockOf<LowLevelTorque::Options> : std::type_identity<LowLevelTorque> {};
template <>
struct BlockOf<KinovaHighVelocityTorque::Options> : std::type_identity<KinovaHighVelocityTorque> {};
template <>
struct BlockOf<KinovaDampedTorque::Options> : std::type_identity<KinovaDampedTorque> {};

}  // namespace

TorqueActuation::TorqueActuation(const Options& o)
    : torque{this, "torque", o.joints},
      acceleration{this, "acceleration", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      measured_torque{this, "measured_torque", o.joints},
      current{this, "current", o.joints},
      torque_error{this, "torque_error", o.joints},
      saturated{this, "saturated"} {
  auto& error = Add<TorqueError>("error", {.joints = o.joints, .reflected_inertia = RotorsOf(o)});
  Connect(torque, error.wanted);
  Connect(acceleration, error.acceleration);
  Connect(measured_torque, error.measured);
  Connect(error.error, torque_error);

  if (!o.motors) {
    auto& none = Add<Constant<MotorCurrent>>(
        "none", {.space = o.joints, .value = MotorCurrent::Zero(o.joints)});
    Connect(none.y, current);
    Connect(Add<Constant<JointBits>>("whole", {.value = 0}).y, saturated);
    return;
  }
  TorqueLoop& loop = std::visit(
      [&](const auto& choice) -> TorqueLoop& {
        const auto options = TorqueLoopOf(*o.motors, choice);
        using Loop = typename BlockOf<std::remove_cv_t<decltype(options)>>::type;
        return Add<Loop>("loop", options);
      },
      o.loop);
  Connect(torque, loop.torque);
  Connect(acceleration, loop.acceleration);
  Connect(measured_velocity, loop.measured_velocity);
  Connect(measured_torque, loop.measured_torque);
  Connect(loop.current, current);
  Connect(loop.saturated, saturated);
}

}  // namespace pliant
