#include "pliant/plants/link_force.h"

namespace pliant {

LinkForce::LinkForce(const Options& o)
    : force{this, "force"},
      motion{this, "motion", o.model.joints()},
      contact{this, "contact"},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      power{this, "power"},
      model_{o.model},
      link_{o.model.link_index(o.link)},
      point_{o.point} {
  Require(o.point.allFinite(), "point must be finite", o.point.transpose());
  Compute(contact).From(force).As(&LinkForce::Act);
  Compute(energy).From().As([] { return 0.0; });
  Compute(dissipation).From().As([] { return 0.0; });
  Compute(power).From(force, motion).As(&LinkForce::Drive);
}

ContactForce LinkForce::Act(const Force& F) const {
  return {link_, point_, F, Eigen::Vector3d::Zero()};
}

double LinkForce::Drive(const Force& F, const RobotDynamics& d) const {
  return F.dot(MotionOf(model_, d, link_, point_).velocity);
}

}  // namespace pliant
