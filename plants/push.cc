#include "pliant/plants/push.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pliant {

Push::Push(const Options& o)
    : force{this, "force"},
      full_{o.model.link_index(o.link), o.point, o.force, Eigen::Vector3d::Zero()},
      start_{o.start_s},
      duration_{o.duration_s},
      edge_{o.edge_s} {
  Require(o.force.allFinite(), "force must be finite", o.force.transpose());
  Require(o.point.allFinite(), "point must be finite", o.point.transpose());
  RequireInRange("", o);
  Require(duration_ >= 2 * edge_, "duration_s must be >= 2 edge_s = " + Text(2 * edge_), duration_);
  Every(o.period).Compute(force).From(clock).As(&Push::At);
}

ContactForce Push::At(double t) const {
  const double s = std::clamp(std::min(t - start_, start_ + duration_ - t) / edge_, 0.0, 1.0);
  ContactForce now = full_;
  now.force *= 0.5 * (1 - std::cos(std::numbers::pi * s));
  return now;
}

ContactTorque::ContactTorque(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      contacts{this, "contacts"},
      torque{this, "torque", o.model.joints()},
      model_{o.model} {
  Compute(torque).From(dynamics, contacts).As(&ContactTorque::Sum);
}

JointTorque ContactTorque::Sum(const RobotDynamics& d, const Joined<ContactForce>& joined) const {
  JointTorque sum = JointTorque::Zero(model_.joints());
  for (int i = 0; i < joined.size(); ++i) sum += ExternalTorque(model_, d, {&joined[i], 1});
  return sum;
}

}  // namespace pliant
