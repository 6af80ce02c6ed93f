#include "pliant/controllers/low_level_torque.h"

#include "pliant/controllers/torque_error.h"
#include "pliant/controllers/torque_to_current.h"
#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/discrete_transfer_function.h"
#include "pliant/systems/leaky_integrator.h"

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

/// τ_m = τ_d + τ_f + λ y + l
class MotorTorque final : public Block {
 public:
  struct Options {
    Joints joints;
    double lag_gain;
  };

  explicit MotorTorque(const Options& o)
      : wanted{this, "wanted", o.joints},
        friction{this, "friction", o.joints},
        lag{this, "lag", o.joints},
        leak{this, "leak", o.joints},
        torque{this, "torque", o.joints},
        lambda_{o.lag_gain} {
    RequireInRange("", "lag_gain", lambda_, "", kNotNegative);
    Compute(torque).From(wanted, friction, lag, leak).As(&MotorTorque::Sum);
  }

  Input<JointTorque> wanted, friction, lag, leak;
  Output<JointTorque> torque;

 private:
  JointTorque Sum(const JointTorque& tau_d, const JointTorque& tau_f, const JointTorque& y,
                  const JointTorque& l) const {
    return tau_d + tau_f + lambda_ * y + l;
  }

  const double lambda_;
};

}  // namespace

LowLevelTorque::LowLevelTorque(const Options& o) : TorqueLoop{o.joints} {
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
  auto& sum = Add<MotorTorque>("sum", {.joints = o.joints, .lag_gain = o.lag_gain});
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
    Connect(torque, sum.wanted);
  else
    Connect(miss.link, sum.wanted);
  Connect(compensation.torque, sum.friction);
  Connect(lag.y, sum.lag);
  Connect(leak.y, sum.leak);
  Connect(sum.torque, motor.torque);
  Connect(motor.current, current);
  Connect(motor.saturated, saturated);
  Connect(miss.error, error);
}

}  // namespace pliant
