#include "pliant/estimators/complementary_fusion.h"

#include "pliant/systems/elements.h"

namespace pliant {

ComplementaryFusion::ComplementaryFusion(const Options& o)
    : residual{this, "residual", o.joints},
      sensor_torque{this, "sensor_torque", o.joints},
      sensor_valid{this, "sensor_valid", {}, true},
      external_torque{this, "external_torque", o.joints},
      decay_{(-o.gain * seconds(o.period)).array().exp()},
      memory_{this,
              "memory",
              o.joints,
              {.low = JointTorque::Zero(o.joints), .last = JointTorque::Zero(o.joints)}} {
  RequireEachInRange("gain", o.gain, "1/s", kPositive, o.joints);
  Every(o.period)
      .Compute(memory_)
      .From(memory_, sensor_torque, sensor_valid)
      .As(&ComplementaryFusion::Next);
  Compute(external_torque).From(residual, memory_).As(&ComplementaryFusion::Fuse);
}

ComplementaryFusion::Memory ComplementaryFusion::Next(const Memory& last, const JointTorque& tau_s,
                                                      bool valid) const {
  if (!valid) return {last.low, last.last, true, false, false};
  if (!last.started) return {last.low, tau_s, true, true, true};
  if (!last.sensed) return {tau_s, tau_s, true, true, false};
  const PerJoint mean = 0.5 * (tau_s + last.last);
  return {decay_.cwiseProduct(last.low) + (1 - decay_.array()).matrix().cwiseProduct(mean), tau_s,
          true, true, true};
}

JointTorque ComplementaryFusion::Fuse(const JointTorque& r, const Memory& m) const {
  if (!m.adds) return r;
  return r + m.last - m.low;
}

}  // namespace pliant
