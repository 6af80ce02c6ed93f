#include "pliant/controllers/kinova_torque.h"

#include "pliant/controllers/torque_error.h"
#include "pliant/controllers/torque_to_current.h"
#include "pliant/plants/kinova_lag.h"
#include "pliant/systems/discrete_transfer_function.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/sum.h"

namespace pliant {

KinovaHighVelocityTorque::KinovaHighVelocityTorque(const Options& o, double damping)
    : TorqueLoop{o.joints} {
  Require(o.period == KinovaLag::period,
          "period must be " + KinovaLag::period.text() + ": H is made for it", o.period.text());
  RequireInRange("", "feedforward", o.feedforward, "", kNotNegative);
  RequireInRange("", "gain", o.gain, "", kNotNegative);
  RequireInRange("", "damping", damping, "N·m·s/rad", kNotNegative);
  auto& miss =
      Add<TorqueError>("error", {.joints = o.joints, .reflected_inertia = o.reflected_inertia});
  auto& commanded = Add<TorqueError>(
      "commanded", {.joints = o.joints, .reflected_inertia = PerJoint::Zero(o.joints.size())});
  auto& lag = Add<DiscreteTransferFunction<JointTorque>>(
      "lag", {.space = o.joints,
              .b = {KinovaLag::b.begin(), KinovaLag::b.end()},
              .a = {KinovaLag::a.begin(), KinovaLag::a.end()},
              .period = o.period});
  auto& feedforward =
      Add<Gain<JointTorque>>("feedforward", {.space = o.joints, .gain = o.feedforward});
  auto& gain = Add<Gain<JointTorque>>("gain", {.space = o.joints, .gain = o.gain});
  auto& damper =
      Add<Gain<JointVelocity, JointTorque>>("damper", {.space = o.joints, .gain = damping});
  auto& sum = Add<Sum<JointTorque>>("sum", {.space = o.joints});
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
  Connect(lag.y, gain.u);
  Connect(torque, feedforward.u);
  Connect(measured_velocity, damper.u);
  Connect(feedforward.y, sum.plus);
  Connect(gain.y, sum.plus);
  Connect(damper.y, sum.minus);
  Connect(sum.y, motor.torque);
  Connect(motor.current, current);
  Connect(motor.saturated, saturated);
  Connect(miss.error, error);
}

}  // namespace pliant
