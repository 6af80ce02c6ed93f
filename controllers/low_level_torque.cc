#include "pliant/controllers/low_level_torque.h"

#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/discrete_transfer_function.h"
#include "pliant/systems/elements.h"
#include "pliant/systems/leaky_integrator.h"

namespace pliant {

namespace {

/// e = τ_d − B q̈_d − τ
class TorqueError final : public Block {
 public:
  TorqueError(const Joints& joints, const PerJoint& reflected_inertia)
      : wanted{this, "wanted", joints},
        acceleration{this, "acceleration", joints},
        measured{this, "measured", joints},
        error{this, "error", joints},
        B_{reflected_inertia} {
    RequireEachInRange("reflected_inertia", B_, "kg·m²", kNotNegative, joints);
    Compute(error).From(wanted, acceleration, measured).As(&TorqueError::Miss);
  }
  Input<JointTorque> wanted;
  Input<JointAcceleration> acceleration;
  Input<JointTorque> measured;
  Output<JointTorque> error;

 private:
  JointTorque Miss(const JointTorque& tau_d, const JointAcceleration& a,
                   const JointTorque& tau) const {
    return tau_d - B_.cwiseProduct(a) - tau;
  }
  const PerJoint B_;
};

/// i = (τ_d + τ_f + λ y + l)/κ
class MotorCommand final : public Block {
 public:
  MotorCommand(const Joints& joints, double lag_gain, const PerJoint& torque_per_ampere)
      : wanted{this, "wanted", joints},
        friction{this, "friction", joints},
        lag{this, "lag", joints},
        leak{this, "leak", joints},
        current{this, "current", joints},
        lambda_{lag_gain},
        kappa_{torque_per_ampere} {
    RequireInRange("", "lag_gain", lambda_, "", kNotNegative);
    RequireEachInRange("torque_per_ampere", kappa_, "N·m/A", kPositive, joints);
    Compute(current).From(wanted, friction, lag, leak).As(&MotorCommand::Convert);
  }
  Input<JointTorque> wanted, friction, lag, leak;
  Output<MotorCurrent> current;

 private:
  MotorCurrent Convert(const JointTorque& tau_d, const JointTorque& tau_f, const JointTorque& y,
                       const JointTorque& l) const {
    return (tau_d + tau_f + lambda_ * y + l).cwiseQuotient(kappa_);
  }
  const double lambda_;
  const PerJoint kappa_;
};

}  // namespace

LowLevelTorque::LowLevelTorque(const Options& o)
    : torque{this, "torque", o.joints},
      acceleration{this, "acceleration", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      measured_torque{this, "measured_torque", o.joints},
      current{this, "current", o.joints},
      error{this, "error", o.joints} {
  RequireInRange("", "leak_gain", o.leak_gain, "", kNotNegative);
  RequireInRange("", "leak_time_s", o.leak_time_s, "s", kPositive);
  RequireEachInRange("leak_limit", o.leak_limit, "N·m", Range{.least = 0, .most = kUnbounded},
                     o.joints);
  Require(o.lag_gain == 0 || o.period == KinovaLag::period,
          "period must be " + KinovaLag::period.text() + " where lag_gain is > 0: H is made for it",
          o.period.text());
  FrictionCompensation::Options friction = o.friction;
  friction.joints = o.joints;
  auto& miss = Add<TorqueError>("error", o.joints, o.reflected_inertia);
  auto& compensation = Add<FrictionCompensation>("friction", friction);
  auto& lag = Add<DiscreteTransferFunction<JointTorque>>(
      "lag", {.space = o.joints,
              .b = {KinovaLag::b.begin(), KinovaLag::b.end()},
              .a = {KinovaLag::a.begin(), KinovaLag::a.end()},
              .period = o.period});
  auto& leak = Add<LeakyIntegrator<JointTorque>>(
      "leak", {.space = o.joints,
               .gain = PerJoint::Constant(o.joints.size(), o.leak_gain),
               .time_constant_s = o.leak_time_s,
               .limit = o.leak_limit,
               .period = o.period});
  auto& sum = Add<MotorCommand>("sum", o.joints, o.lag_gain, o.torque_per_ampere);

  Connect(torque, miss.wanted);
  Connect(acceleration, miss.acceleration);
  Connect(measured_torque, miss.measured);
  Connect(measured_velocity, compensation.velocity);
  Connect(acceleration, compensation.acceleration);
  Connect(miss.error, lag.u);
  Connect(miss.error, leak.u);
  Connect(torque, sum.wanted);
  Connect(compensation.torque, sum.friction);
  Connect(lag.y, sum.lag);
  Connect(leak.y, sum.leak);
  Connect(sum.current, current);
  Connect(miss.error, error);
}

}  // namespace pliant
