#pragma once

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// The torque that is missing behind the gears, where the rotors take nothing any more:
///
///   e = τ_d − B q̈_d − τ
class TorqueError final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint reflected_inertia;  ///< B [kg·m²], each ≥ 0
  };

  explicit TorqueError(const Options& o)
      : wanted{this, "wanted", o.joints},
        acceleration{this, "acceleration", o.joints},
        measured{this, "measured", o.joints},
        link{this, "link", o.joints},
        error{this, "error", o.joints},
        B_{o.reflected_inertia} {
    RequireEachInRange("reflected_inertia", B_, "kg·m²", kNotNegative, o.joints);
    Compute(link).From(wanted, acceleration).As(&TorqueError::BehindTheGears);
    Compute(error).From(link, measured).As([](const JointTorque& tau_l, const JointTorque& tau) {
      return JointTorque(tau_l - tau);
    });
  }

  Input<JointTorque> wanted;              ///< τ_d, rotors included
  Input<JointAcceleration> acceleration;  ///< q̈_d
  Input<JointTorque> measured;            ///< τ
  Output<JointTorque> link;               ///< τ_d − B q̈_d
  Output<JointTorque> error;              ///< e

 private:
  JointTorque BehindTheGears(const JointTorque& tau_d, const JointAcceleration& a) const {
    return tau_d - B_.cwiseProduct(a);
  }

  const PerJoint B_;
};

}  // namespace pliant
