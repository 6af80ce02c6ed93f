#pragma once

#include "pliant/controllers/null_space.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Which form of the null-space impedance of NS.
enum class NullSpaceLaw {
  Printed,  ///< its equation
  Meant,    ///< what its text says of friction
};

inline const std::vector<std::string>& Words(NullSpaceLaw) {
  static const std::vector<std::string> words{"printed", "meant"};
  return words;
}

/// Damping of what an arm does besides moving its tool, and compensation of friction there:
///
///   q̇_d = J† [0; ṗ̃_d]
///   printed   τⁿ = N d_n ( α_f q̇_d + (α_d/d_n) (q̇_d − q̇) )                            (NS 9)
///   meant     τⁿ = N ( α_f c ∘ tanh(d_n q̇/c) + α_d (q̇_d − q̇) )
///
/// N J† = 0, so N q̇_d ≡ 0: as printed the law is τⁿ = −α_d N q̇, and α_f and d_n do nothing. The
/// text wants a feedforward of "joint frictional torques" that eases the joints' answer to a push;
/// that needs the measured velocity. Its friction is d_n q̇ (its proof of passivity), which no dry
/// friction is: here it ends at the Coulomb friction c of each joint. c = 0 compensates nothing,
/// c = ∞ is d_n q̇ itself.
///
/// −α_d N q̇ takes energy, N being ⪰ 0. What is meant gives some: never more than friction takes
/// where the friction there is at least what is assumed, joint by joint, and N were diagonal; it
/// is not, so nothing is promised, and an arm without friction is driven.
///
/// Source: Yang, Wang & Kermani 2025 (NS).
class NullSpaceImpedance final : public Block {
 public:
  struct Options {
    Joints joints;
    NullSpaceLaw law = NullSpaceLaw::Printed;
    double damping = 5;        ///< d_n > 0 [N·m·s/rad]
    double friction_gain = 1;  ///< α_f ≥ 0
    double damping_gain = 1;   ///< α_d ≥ 0 [N·m·s/rad]
    PerJoint coulomb = {};     ///< c, each ≥ 0 [N·m], ∞ allowed; of `meant`; empty: 0
  };

  explicit NullSpaceImpedance(const Options& o);

  Input<NullSpace> null_space;
  Input<LinearVelocity> desired{this, "desired"};  ///< ṗ̃_d
  Input<JointVelocity> velocity;                   ///< q̇
  Output<JointVelocity> desired_velocity;          ///< q̇_d
  Output<JointTorque> torque;                      ///< τⁿ

 private:
  JointTorque Act(const NullSpace& of, const JointVelocity& qd_dot, const JointVelocity& v) const;

  const Options o_;
};

}  // namespace pliant
