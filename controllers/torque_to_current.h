#pragma once

#include <algorithm>
#include <cmath>

#include "pliant/plants/arm_status.h"
#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// The current that makes a torque behind the gear, cut at what the motor may have:
///
///   i = clamp(τ_m/κ, ± i_max)
///
/// `side` says to which side a current was cut at the tick before, for what must not wind up: 1,
/// −1, or 0 if it was not.
class TorqueToCurrent final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint torque_per_ampere;       ///< κ [N·m/A], each > 0
    MotorCurrent current_limit = {};  ///< i_max [A], each > 0; empty: none
    Duration period;                  ///< of `side`
  };

  explicit TorqueToCurrent(const Options& o)
      : torque{this, "torque", o.joints},
        current{this, "current", o.joints},
        saturated{this, "saturated"},
        side{this, "side", {}, PerJoint::Zero(o.joints.size())},
        kappa_{o.torque_per_ampere},
        i_max_{o.current_limit.size() > 0
                   ? PerJoint(o.current_limit)
                   : PerJoint(PerJoint::Constant(o.joints.size(), kUnbounded))},
        side_{this, "last_side", {}, PerJoint::Zero(o.joints.size())} {
    RequireEachInRange("torque_per_ampere", kappa_, "N·m/A", kPositive, o.joints);
    RequireEachInRange("current_limit", i_max_, "A", kLimit, o.joints);
    Compute(current).From(torque).As(&TorqueToCurrent::Convert);
    Compute(saturated).From(torque).As(&TorqueToCurrent::Cut);
    Compute(side).From(side_).As([](const PerJoint& s) { return s; });
    Every(o.period).Update(side_).From(torque).As(&TorqueToCurrent::Side);
  }

  Input<JointTorque> torque;     ///< τ_m
  Output<MotorCurrent> current;  ///< i
  Output<JointBits> saturated;   ///< joints whose current is cut
  Output<PerJoint> side;

 private:
  MotorCurrent Convert(const JointTorque& tau) const {
    return tau.cwiseQuotient(kappa_).cwiseMin(i_max_).cwiseMax(-i_max_);
  }
  PerJoint Side(const JointTorque& tau) const {
    const auto side = [](double tau_m, double kappa, double most) {
      return tau_m / kappa > most ? 1. : tau_m / kappa < -most ? -1. : 0.;
    };
    return EachElement<PerJoint>(side, tau, kappa_, i_max_);
  }
  JointBits Cut(const JointTorque& tau) const {
    const PerJoint side = Side(tau);
    JointBits cut = 0;
    for (Eigen::Index j = 0; j < side.size(); ++j)
      if (side(j) != 0) cut |= JointBits{1} << j;
    return cut;
  }

  const PerJoint kappa_, i_max_;
  Discrete<PerJoint> side_;
};

}  // namespace pliant
