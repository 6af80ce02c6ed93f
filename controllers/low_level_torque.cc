#include "pliant/controllers/low_level_torque.h"

#include "pliant/controllers/torque_error.h"
#include "pliant/controllers/torque_to_current.h"
#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/discrete_transfer_function.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/leaky_integrator.h"
#include "pliant/systems/sum.h"

namespace pliant {

namespace {

/// What of an error may still be integrated while currents are cut: that which leads away from the
/// side they are cut at.
class Room final : public Block {
 public:
  struct Options {
    Joints joints;
  };

  explicit Room(const Options& o)
      : error{this, "error", o.joints},
        side{this, "side", {}, PerJoint::Zero(o.joints.size())},
        left{this, "left", o.joints} {
    Compute(left).From(error, side).As([](const JointTorque& e, const PerJoint& cut) {
      return EachElement<JointTorque>([](double x, double at) { return x * at > 0 ? 0 : x; }, e,
                                      cut);
    });
  }

  Input<JointTorque> error;
  Input<PerJoint> side;
  Output<JointTorque> left;
};

}  // namespace

LowLevelTorque::LowLevelTorque(const Options& o) : TorqueLoop{o.joints} {
  RequireInRange("", "lag_gain", o.lag_gain, "", kNotNegative);
  RequireInRange("", "leak_gain", o.leak_gain, "", kNotNegative);
  RequireInRange("", "leak_time_s", o.leak_time_s, "s", kPositive);
  RequireEachInRange("leak_limit", o.leak_limit, "N·m", Range{.least = 0, .most = kUnbounded},
                     o.joints);
  Require(o.lag_gain == 0 || o.period == KinovaLag::period,
          "period must be " + KinovaLag::period.text() + " where lag_gain is > 0: H is made for it",
          o.period.text());
  FrictionCompensation::Options friction = o.friction;
  friction.joints = o.joints;
  if (!o.friction_feedforward)
    for (PerJoint* figure : {&friction.coulomb, &friction.viscous, &friction.stiction})
      figure->setZero(o.joints.size());
  auto& miss =
      Add<TorqueError>("error", {.joints = o.joints, .reflected_inertia = o.reflected_inertia});
  auto& compensation = Add<FrictionCompensation>("friction", friction);
  auto& lag = Add<DiscreteTransferFunction<JointTorque>>(
      "lag", {.space = o.joints,
              .b = {KinovaLag::b.begin(), KinovaLag::b.end()},
              .a = {KinovaLag::a.begin(), KinovaLag::a.end()},
              .period = o.period});
  auto& room = Add<Room>("room", {.joints = o.joints});
  auto& leak = Add<LeakyIntegrator<JointTorque>>(
      "leak", {.space = o.joints,
               .gain = PerJoint::Constant(o.joints.size(), o.leak_gain),
               .time_constant_s = o.leak_time_s,
               .limit = o.leak_limit,
               .period = o.period});
  auto& lambda = Add<Gain<JointTorque>>("lag_gain", {.space = o.joints, .gain = o.lag_gain});
  auto& sum = Add<Sum<JointTorque>>("sum", {.space = o.joints});
  auto& motor = Add<TorqueToCurrent>("motor", {.joints = o.joints,
                                               .torque_per_ampere = o.torque_per_ampere,
                                               .current_limit = o.current_limit,
                                               .period = o.period});

  Connect(torque, miss.wanted);
  Connect(acceleration, miss.acceleration);
  Connect(measured_torque, miss.measured);
  Connect(measured_velocity, compensation.velocity);
  Connect(acceleration, compensation.acceleration);
  Connect(miss.error, lag.u);
  Connect(miss.error, room.error);
  Connect(motor.side, room.side);
  Connect(room.left, leak.u);
  if (o.rotor_feedforward)
    Connect(torque, sum.plus);
  else
    Connect(miss.link, sum.plus);
  Connect(compensation.torque, sum.plus);
  Connect(lag.y, lambda.u);
  Connect(lambda.y, sum.plus);
  Connect(leak.y, sum.plus);
  Connect(sum.y, motor.torque);
  Connect(motor.current, current);
  Connect(motor.saturated, saturated);
  Connect(miss.error, error);
}

}  // namespace pliant
