#include "pliant/estimators/complementary_fusion.h"

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
  Require(o.gain.size() == o.joints.size(),
          "gain has an element for each of the " + Text(o.joints.size()) + " joints",
          o.gain.size());
  Require(o.gain.allFinite() && o.gain.minCoeff() > 0, "every gain must be finite and > 0",
          o.gain.transpose());
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
