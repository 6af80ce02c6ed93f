#include "pliant/estimators/complementary_fusion.h"

#include "pliant/systems/elements.h"

namespace pliant {

ComplementaryFusion::ComplementaryFusion(const Options& o)
    : residual{this, "residual", o.joints},
      sensor_torque{this, "sensor_torque", o.joints},
      external_torque{this, "external_torque", o.joints},
      decay_{(-o.gain * seconds(o.period)).array().exp()},
      memory_{this,
              "memory",
              o.joints,
              {JointTorque::Zero(o.joints), JointTorque::Zero(o.joints), false}} {
  RequireEachInRange("gain", o.gain, "1/s", kPositive, o.joints);
  Every(o.period).Compute(memory_).From(memory_, sensor_torque).As(&ComplementaryFusion::Next);
  Compute(external_torque).From(residual, memory_).As(&ComplementaryFusion::Fuse);
}

ComplementaryFusion::Memory ComplementaryFusion::Next(const Memory& last,
                                                      const JointTorque& tau_s) const {
  if (!last.started) return {last.low, tau_s, true};
  const PerJoint mean = 0.5 * (tau_s + last.last);
  return {decay_.cwiseProduct(last.low) + (1 - decay_.array()).matrix().cwiseProduct(mean), tau_s,
          true};
}

}  // namespace pliant
