#include "pliant/plants/joint_friction.h"

#include <algorithm>

namespace pliant {

JointFriction::JointFriction(const Options& o)
    : velocity{this, "velocity", o.joints},
      torque{this, "torque", o.joints},
      deflection{this, "deflection", o.joints},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      law_{o.law},
      p_{o.parameters},
      zdot_{this, "zdot", o.joints} {
  RequireOneForEach(o.joints, "parameters", std::ssize(p_));
  for (int j = 0; j < o.joints.size(); ++j)
    RequireInRange(o.joints[j], p_[static_cast<std::size_t>(j)]);
  const auto slips_dry = [](const FrictionParameters& p) {
    return p.stiction > 0 && p.coulomb == 0;
  };

  if (law_ == FrictionLaw::LuGre || law_ == FrictionLaw::ElastoPlastic) {
    Require(std::ranges::none_of(p_, slips_dry), "coulomb must be > 0 where stiction is");
    z_.emplace(this, "z", o.joints);
    Compute(zdot_).From(*z_, velocity).As(&JointFriction::Bend);
    Derivative(*z_).From(zdot_).As([](const JointVelocity& zdot) { return zdot; });
    Compute(deflection).From(*z_).As([](const JointPosition& z) { return z; });
    Compute(torque).From(*z_, zdot_, velocity).As(&JointFriction::OfBristles);
  } else {
    const auto none = [](const JointVelocity& v) { return PerJoint(PerJoint::Zero(v.size())); };
    Compute(deflection).From(velocity).As(none);
    Compute(zdot_).From(velocity).As(none);
    Compute(torque).From(velocity).As(&JointFriction::Smooth);
  }
  Compute(energy).From(deflection).As(&JointFriction::Energy);
  Compute(dissipation).From(deflection, zdot_, velocity, torque).As(&JointFriction::Dissipate);
}

JointTorque JointFriction::Smooth(const JointVelocity& v) const {
  JointTorque tau;
  tau.resize(v.size());
  for (Eigen::Index j = 0; j < v.size(); ++j)
    tau(j) = SmoothFriction(law_, p_[static_cast<std::size_t>(j)], v(j));
  return tau;
}

JointVelocity JointFriction::Bend(const JointPosition& z, const JointVelocity& v) const {
  JointVelocity rate;
  rate.resize(v.size());
  for (Eigen::Index j = 0; j < v.size(); ++j)
    rate(j) = BristleRate(law_, p_[static_cast<std::size_t>(j)], z(j), v(j));
  return rate;
}

JointTorque JointFriction::OfBristles(const JointPosition& z, const JointVelocity& zdot,
                                      const JointVelocity& v) const {
  JointTorque tau;
  tau.resize(v.size());
  for (Eigen::Index j = 0; j < v.size(); ++j) {
    const FrictionParameters& p = p_[static_cast<std::size_t>(j)];
    tau(j) = p.bristle_stiffness * z(j) + p.bristle_damping * zdot(j) + p.viscous * v(j);
  }
  return tau;
}

double JointFriction::Energy(const JointPosition& z) const {
  double sum = 0;
  for (Eigen::Index j = 0; j < z.size(); ++j)
    sum += 0.5 * p_[static_cast<std::size_t>(j)].bristle_stiffness * z(j) * z(j);
  return sum;
}

double JointFriction::Dissipate(const JointPosition& z, const JointVelocity& zdot,
                                const JointVelocity& v, const JointTorque& tau) const {
  double power = tau.dot(v);
  for (Eigen::Index j = 0; j < z.size(); ++j)
    power -= p_[static_cast<std::size_t>(j)].bristle_stiffness * z(j) * zdot(j);
  return power;
}

}  // namespace pliant
