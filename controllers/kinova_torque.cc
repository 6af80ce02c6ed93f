#include "pliant/controllers/kinova_torque.h"

#include "pliant/controllers/torque_error.h"
#include "pliant/controllers/torque_to_current.h"
#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/discrete_transfer_function.h"

namespace pliant {

namespace {

/// τ_m = f τ_d + k y − d q̇
class MotorTorque final : public Block {
 public:
  struct Options {
    Joints joints;
    double feedforward, gain, damping;
  };

  explicit MotorTorque(const Options& o)
      : wanted{this, "wanted", o.joints},
        lag{this, "lag", o.joints},
        velocity{this, "velocity", o.joints},
        torque{this, "torque", o.joints},
        f_{o.feedforward},
        k_{o.gain},
        d_{o.damping} {
    RequireInRange("", "feedforward", f_, "", kNotNegative);
    RequireInRange("", "gain", k_, "", kNotNegative);
    RequireInRange("", "damping", d_, "N·m·s/rad", kNotNegative);
    Compute(torque).From(wanted, lag, velocity).As(&MotorTorque::Sum);
  }

  Input<JointTorque> wanted, lag;
  Input<JointVelocity> velocity;
  Output<JointTorque> torque;

 private:
  JointTorque Sum(const JointTorque& tau_d, const JointTorque& y, const JointVelocity& v) const {
    return f_ * tau_d + k_ * y - d_ * PerJoint(v);
  }

  const double f_, k_, d_;
};

}  // namespace

KinovaHighVelocityTorque::KinovaHighVelocityTorque(const Options& o, double damping)
    : TorqueLoop{o.joints} {
  Require(o.period == KinovaLag::period,
          "period must be " + KinovaLag::period.text() + ": H is made for it", o.period.text());
  auto& miss =
      Add<TorqueError>("error", {.joints = o.joints, .reflected_inertia = o.reflected_inertia});
  auto& commanded = Add<TorqueError>(
      "commanded", {.joints = o.joints, .reflected_inertia = PerJoint::Zero(o.joints.size())});
  auto& lag = Add<DiscreteTransferFunction<JointTorque>>(
      "lag", {.space = o.joints,
              .b = {KinovaLag::b.begin(), KinovaLag::b.end()},
              .a = {KinovaLag::a.begin(), KinovaLag::a.end()},
              .period = o.period});
  auto& sum = Add<MotorTorque>(
      "sum",
      {.joints = o.joints, .feedforward = o.feedforward, .gain = o.gain, .damping = damping});
  auto& motor = Add<TorqueToCurrent>("motor", {.joints = o.joints,
                                               .torque_per_ampere = o.torque_per_ampere,
                                               .current_limit = o.current_limit,
                                               .period = o.period});

  for (TorqueError* e : {&miss, &commanded}) {
    Connect(torque, e->wanted);
    Connect(acceleration, e->acceleration);
    Connect(measured_torque, e->measured);
  }
  Connect(commanded.error, lag.u);
  Connect(torque, sum.wanted);
  Connect(lag.y, sum.lag);
  Connect(measured_velocity, sum.velocity);
  Connect(sum.torque, motor.torque);
  Connect(motor.current, current);
  Connect(motor.saturated, saturated);
  Connect(miss.error, error);
}

}  // namespace pliant
