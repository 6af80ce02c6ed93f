#include "pliant/plants/mass_on_rope.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "pliant/systems/parameter.h"

namespace pliant {

MassOnRope::MassOnRope(const Options& o)
    : motion{this, "motion", o.model.joints()},
      contact{this, "contact"},
      position{this, "position"},
      velocity{this, "velocity"},
      tension{this, "tension"},
      taut{this, "taut"},
      catches{this, "catches"},
      energy{this, "energy"},
      dissipation{this, "dissipation"},
      model_{o.model},
      link_{o.model.link_index(o.link)},
      point_{o.point},
      m_{o.mass},
      L_{o.length},
      k_{o.stiffness},
      d_{o.damping},
      x_{this, "x", {}, o.position},
      v_{this, "v", {}, o.velocity},
      taut_{this, "is_taut"},
      catches_{this, "caught"},
      released_{this, "released"},
      rope_{this, "rope"},
      grip_{this, "grip"},
      T_{this, "T"} {
  Require(o.point.allFinite(), "point must be finite", o.point.transpose());
  Require(o.position.allFinite(), "position must be finite", o.position.transpose());
  Require(o.velocity.allFinite(), "velocity must be finite", o.velocity.transpose());
  RequireInRange("", o);
  RequireInRange("", "release", seconds(o.release), "s", kNotNegative);

  Every(kOnce, o.release).Compute(released_).From().As([] { return true; });
  Compute(position).From(x_).As([](const Position& x) { return x; });
  Compute(velocity).From(released_, v_).As([](bool released, const LinearVelocity& v) {
    return released ? v : LinearVelocity();
  });
  Compute(rope_).From(position, velocity, motion).As(&MassOnRope::Span);

  Compute(grip_).From(taut_, rope_).As(&MassOnRope::Grip);
  AtStart().Update(taut_).From(rope_).As(&MassOnRope::StartsTaut);
  When(grip_).Crosses(Direction::Rising).Update(taut_, catches_).From(catches_).As([](int n) {
    return std::tuple(true, n + 1);
  });
  When(grip_).Crosses(Direction::Falling).Update(taut_).From().As([] { return false; });
  Compute(taut).From(taut_).As([](bool is) { return is; });
  Compute(catches).From(catches_).As([](int n) { return n; });

  Compute(T_).From(taut_, rope_).As(&MassOnRope::Pull);
  Compute(tension).From(T_).As([](double T) { return std::max(0.0, T); });
  Compute(contact).From(T_, rope_).As(&MassOnRope::Act);
  Derivative(x_).From(velocity).As([](const LinearVelocity& v) { return v; });
  Derivative(v_).From(released_, T_, rope_).As(&MassOnRope::Accelerate);
  Compute(energy).From(rope_, position, velocity).As(&MassOnRope::Store);
  Compute(dissipation).From(tension, rope_).As(&MassOnRope::Dissipate);
}

MassOnRope::Rope MassOnRope::Span(const Position& x, const LinearVelocity& v,
                                  const RobotDynamics& d) const {
  const PointMotion a = MotionOf(model_, d, link_, point_);
  const Eigen::Vector3d r = x - a.position;
  const double length = r.norm();
  // Without a length there is no direction, and no tension: L > 0.
  const Eigen::Vector3d u = r / std::max(length, std::numeric_limits<double>::min());
  return {u, length - L_, u.dot(v - a.velocity)};
}

bool MassOnRope::StartsTaut(const Rope& rope) const { return Grip(true, rope) > 0; }

double MassOnRope::Grip(const bool& is_taut, const Rope& rope) const {
  const double grip = k_ * rope.delta + d_ * std::min(0.0, rope.delta_dot);
  // Zero belongs to what the rope is, so that one which starts just straight can become slack.
  return grip != 0 ? grip : std::copysign(std::numeric_limits<double>::min(), is_taut ? 1 : -1);
}

// Not clipped: a step that looks beyond the end of a taut phase must not meet a kink there.
double MassOnRope::Pull(const bool& is_taut, const Rope& rope) const {
  return is_taut ? k_ * rope.delta + d_ * rope.delta_dot : 0.0;
}

LinearAcceleration MassOnRope::Accelerate(const bool& released, const double& T,
                                          const Rope& rope) const {
  if (!released) return {};
  return model_.gravity() - T / m_ * rope.u;
}

ContactForce MassOnRope::Act(const double& T, const Rope& rope) const {
  return {link_, point_, T * rope.u, Eigen::Vector3d::Zero()};
}

double MassOnRope::Store(const Rope& rope, const Position& x, const LinearVelocity& v) const {
  const double delta = std::max(0.0, rope.delta);
  return 0.5 * k_ * delta * delta + 0.5 * m_ * v.squaredNorm() - m_ * model_.gravity().dot(x);
}

double MassOnRope::Dissipate(const double& T, const Rope& rope) const {
  if (T > 0) return d_ * rope.delta_dot * rope.delta_dot;
  return std::max(0.0, -k_ * std::max(0.0, rope.delta) * rope.delta_dot);
}

}  // namespace pliant
