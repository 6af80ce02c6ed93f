#include "pliant/plants/surface.h"

#include <cmath>

#include "pliant/plants/hunt_crossley.h"
#include "pliant/systems/parameter.h"

namespace pliant {

Surface::Surface(const Options& o)
    : motion{this, "motion", o.model.joints()},
      contact{this, "contact"},
      penetration{this, "penetration"},
      normal_force{this, "normal_force"},
      touching{this, "touching"},
      touches{this, "touches"},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      model_{o.model},
      link_{o.model.link_index(o.link)},
      point_{o.point},
      origin_{o.origin},
      n_{o.normal.stableNormalized()},
      radius_{o.radius},
      k_{o.stiffness},
      c_{o.damping},
      mu_{o.friction},
      v_s_{o.slip_speed},
      touches_{this, "came_down"},
      touch_{this, "touch"} {
  Require(o.point.allFinite(), "point must be finite", o.point.transpose());
  Require(o.origin.allFinite(), "origin must be finite", o.origin.transpose());
  Require(o.normal.allFinite() && o.normal.stableNorm() > 0, "normal must be finite and not zero",
          o.normal.transpose());
  RequireInRange("", o);

  Compute(touch_).From(motion).As(&Surface::Meet);
  Compute(penetration).From(touch_).As([](const Touch& touch) { return touch.p; });
  Compute(touching).From(penetration).As([](double p) { return p > 0; });
  When(penetration).Crosses(Direction::Rising).Update(touches_).From(touches_).As([](int n) {
    return n + 1;
  });
  Compute(touches).From(touches_).As([](int n) { return n; });
  Compute(normal_force).From(touch_).As(&Surface::Press);
  Compute(contact).From(normal_force, touch_).As(&Surface::Act);
  Compute(energy).From(penetration).As(&Surface::Store);
  Compute(dissipation).From(normal_force, touch_).As(&Surface::Dissipate);
}

Surface::Touch Surface::Meet(const RobotDynamics& d) const {
  const Eigen::Matrix3d R_WL = LinkPose(model_, d, link_).rotation;
  const Eigen::Vector3d deepest = point_ - radius_ * R_WL.transpose() * n_;
  const PointMotion x = MotionOf(model_, d, link_, deepest);
  const double p_dot = -n_.dot(x.velocity);
  return {deepest, x.velocity + p_dot * n_, -n_.dot(x.position - origin_), p_dot};
}

double Surface::Press(const Touch& touch) const {
  return HuntCrossleyForce(k_, c_, touch.p, touch.p_dot);
}

Eigen::Vector3d Surface::Rub(const double& N, const Touch& touch) const {
  return -mu_ * N / std::hypot(touch.v_t.norm(), v_s_) * touch.v_t;
}

ContactForce Surface::Act(const double& N, const Touch& touch) const {
  return {link_, touch.point, N * n_ + Rub(N, touch), Eigen::Vector3d::Zero()};
}

double Surface::Store(const double& p) const { return p > 0 ? 0.5 * k_ * p * p : 0.0; }

double Surface::Dissipate(const double& N, const Touch& touch) const {
  return HuntCrossleyLoss(k_, c_, touch.p, touch.p_dot) - Rub(N, touch).dot(touch.v_t);
}

}  // namespace pliant
