#include "pliant/plants/hand.h"

#include <algorithm>

#include "pliant/systems/elements.h"

namespace pliant {

Hand::Hand(const Options& o)
    : path(o.anchored ? Input<Position>(this, "path", {}, Position())
                      : Input<Position>(this, "path")),
      path_velocity{this, "path_velocity", {}, LinearVelocity()},
      grip{this, "grip", {}, 1.0},
      motion{this, "motion", o.model.joints()},
      contact{this, "contact"},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      power{this, "power"},
      model_{o.model},
      link_{o.model.link_index(o.link)},
      point_{o.point},
      k_{o.stiffness},
      d_{o.damping},
      anchor_{this, "anchor"},
      held_{this, "held", {}, true},
      holds_{this, "holds"},
      pull_{this, "pull"} {
  Require(o.point.allFinite(), "point must be finite", o.point.transpose());
  RequireEachInRange("stiffness", k_, "N/m", kNotNegative);
  RequireInRange("", o);

  Compute(holds_).From(grip).As([](double g) { return g > 0 ? 1.0 : -1.0; });
  if (o.anchored) {
    AtStart().Update(anchor_).From(path, motion).As(&Hand::TakeHold);
    // Once more when the first tick of a path that is sampled has come.
    Every(kOnce).Update(anchor_).From(path, motion).As(&Hand::TakeHold);
    When(holds_).Crosses(Direction::Rising).Update(anchor_).From(path, motion).As(&Hand::TakeHold);
    const auto holds = [](double g) { return g > 0; };
    AtStart().Update(held_).From(grip).As(holds);
    Every(kOnce).Update(held_).From(grip).As(holds);
    When(holds_).Crosses(Direction::Rising).Update(held_).From(grip).As(holds);
    When(holds_).Crosses(Direction::Falling).Update(held_).From(grip).As(holds);
  }
  Compute(pull_).From(grip, anchor_, held_, path, path_velocity, motion).As(&Hand::Stretch);
  Compute(contact).From(pull_).As(&Hand::Act);
  Compute(energy).From(pull_).As(&Hand::Store);
  Compute(dissipation).From(pull_).As(&Hand::Dissipate);
  Compute(power).From(contact, path_velocity).As(&Hand::Drive);
}

Hand::Pull Hand::Stretch(const double& g, const Position& anchor, bool held,
                         const Position& path_now, const LinearVelocity& path_rate,
                         const RobotDynamics& d) const {
  const PointMotion x = MotionOf(model_, d, link_, point_);
  return {held ? std::clamp(g, 0.0, 1.0) : 0, anchor + path_now - x.position,
          path_rate - x.velocity};
}

Position Hand::TakeHold(const Position& path_now, const RobotDynamics& d) const {
  return MotionOf(model_, d, link_, point_).position - path_now;
}

ContactForce Hand::Act(const Pull& p) const {
  return {link_, point_, p.g * (k_.cwiseProduct(p.e) + d_ * p.edot), Eigen::Vector3d::Zero()};
}

double Hand::Store(const Pull& p) const { return 0.5 * p.g * p.e.dot(k_.cwiseProduct(p.e)); }

double Hand::Dissipate(const Pull& p) const { return p.g * d_ * p.edot.squaredNorm(); }

double Hand::Drive(const ContactForce& F, const LinearVelocity& path_rate) const {
  return F.force.dot(path_rate);
}

}  // namespace pliant
