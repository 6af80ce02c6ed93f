#include "pliant/plants/joint_stops.h"

#include <cmath>
#include <string>

#include "pliant/plants/hunt_crossley.h"
#include "pliant/systems/parameter.h"

namespace pliant {

namespace {

/// x, or `otherwise` where it was left out; checked to have an element per joint.
template <class V>
V OrElse(const V& x, const V& otherwise, const Joints& joints, std::string_view name) {
  if (x.size() == 0) return otherwise;
  RequireOneForEach(joints, name, x.size());
  return x;
}

/// ṗ, where p is signed by the end of the range it is beyond.
double Deepening(double p, double v) { return p > 0 ? v : -v; }

}  // namespace

JointStops::JointStops(const Options& o)
    : position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      penetration{this, "penetration", o.model.joints()},
      stopped{this, "stopped"},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      lower_{OrElse(o.lower, o.model.lower_limit(), o.model.joints(), "lower")},
      upper_{OrElse(o.upper, o.model.upper_limit(), o.model.joints(), "upper")},
      k_{o.stiffness},
      c_{OrElse(o.damping, PerJoint(PerJoint::Zero(o.model.size())), o.model.joints(), "damping")} {
  RequireOneForEach(o.model.joints(), "stiffness", k_.size());
  for (int i = 0; i < o.model.size(); ++i) {
    const std::string of_joint = "[" + o.model.joint(i).name + "]";
    const bool slides = o.model.joint(i).type == Joint::Type::Prismatic;
    RequireInRange("", "stiffness" + of_joint, k_(i), slides ? "N/m" : "N·m/rad", kPositive);
    RequireInRange("", "damping" + of_joint, c_(i), slides ? "s/m" : "s/rad", kNotNegative);
    Require(lower_(i) < upper_(i), "lower" + of_joint + " must be < upper = " + Text(upper_(i)),
            lower_(i));
  }

  Compute(penetration).From(position).As(&JointStops::Penetrate);
  Compute(torque).From(penetration, velocity).As(&JointStops::Push);
  Compute(stopped).From(penetration).As([](const JointPosition& p) {
    return static_cast<int>((p.array() != 0).count());
  });
  Compute(energy).From(penetration).As(&JointStops::Store);
  Compute(dissipation).From(penetration, velocity).As(&JointStops::Dissipate);
}

JointPosition JointStops::Penetrate(const JointPosition& q) const {
  return q - q.cwiseMin(upper_).cwiseMax(lower_);
}

JointTorque JointStops::Push(const JointPosition& p, const JointVelocity& v) const {
  JointTorque tau;
  tau.resize(p.size());
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const double N = HuntCrossleyForce(k_(i), c_(i), std::abs(p(i)), Deepening(p(i), v(i)));
    tau(i) = -std::copysign(N, p(i));
  }
  return tau;
}

double JointStops::Store(const JointPosition& p) const { return 0.5 * p.dot(k_.cwiseProduct(p)); }

double JointStops::Dissipate(const JointPosition& p, const JointVelocity& v) const {
  double sum = 0;
  for (Eigen::Index i = 0; i < p.size(); ++i)
    sum += HuntCrossleyLoss(k_(i), c_(i), std::abs(p(i)), Deepening(p(i), v(i)));
  return sum;
}

}  // namespace pliant
