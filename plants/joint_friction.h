#pragma once

#include <optional>
#include <vector>

#include "pliant/plants/friction.h"
#include "pliant/systems/block.h"

namespace pliant {

/// The friction of every joint, τ_f(ω, z), by one law: subtract it from what drives the joint.
class JointFriction final : public Block {
 public:
  struct Options {
    Joints joints;
    FrictionLaw law = FrictionLaw::ElastoPlastic;
    std::vector<FrictionParameters> parameters;  ///< of each joint
  };

  explicit JointFriction(const Options& o);

  Input<JointVelocity> velocity;     ///< ω
  Output<JointTorque> torque;        ///< τ_f
  Output<JointPosition> deflection;  ///< z; zero without bristles
  Output<double> energy;             ///< in the bristles, Σ ½ σ₀ z² [J]
  Output<double> dissipation;        ///< Σ τ_f ω − σ₀ z ż [W]

 private:
  JointTorque Smooth(const JointVelocity& v) const;
  JointTorque OfBristles(const JointPosition& z, const JointVelocity& zdot,
                         const JointVelocity& v) const;
  JointVelocity Bend(const JointPosition& z, const JointVelocity& v) const;
  double Energy(const JointPosition& z) const;
  double Dissipate(const JointPosition& z, const JointVelocity& zdot, const JointVelocity& v,
                   const JointTorque& tau) const;

  const FrictionLaw law_;
  const std::vector<FrictionParameters> p_;
  std::optional<Continuous<JointPosition>> z_;
  Output<JointVelocity> zdot_;
};

}  // namespace pliant
