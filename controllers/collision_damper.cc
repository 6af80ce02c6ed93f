#include "pliant/controllers/collision_damper.h"

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <utility>

namespace pliant {
namespace {

using Eigen::Vector3d;

std::size_t At(int i) { return static_cast<std::size_t>(i); }

/// Rows of pairs of smaller effect than this are left out [m/rad].
constexpr double kNoEffect = 1e-9;

const BodyMotion& MotionOfBody(const RobotDynamics& d, int body) {
  static const BodyMotion world;
  return body < 0 ? world : d.body[At(body)];
}

Vector3d VelocityAt(const BodyMotion& B, const Vector3d& point) {
  return B.velocity + B.omega.cross(point - B.position);
}

/// At v̇ = 0.
Vector3d AccelerationAt(const BodyMotion& B, const Vector3d& point) {
  const Vector3d r = point - B.position;
  return B.acceleration + B.alpha.cross(r) + B.omega.cross(B.omega.cross(r));
}

}  // namespace

CollisionDamper::CollisionDamper(const Options& o)
    : CollisionDamper(o, CollisionGeometry(o.model, o.pairs, o.obstacles)) {}

CollisionDamper::CollisionDamper(const Options& o, CollisionGeometry geometry)
    : dynamics{this, "dynamics", o.model.joints()},
      rows{this, "rows", o.model.joints(),
           AccelerationRows::None(geometry.size(), o.model.size(), o.priority)},
      distance{this, "distance", geometry.names()},
      geometry_{std::move(geometry)},
      model_{o.model},
      damper_{o.damper},
      d_s_{o.safety_distance},
      delta_{o.softening},
      A_{o.closing_acceleration} {
  RequireInRange("", o);
  Compute(rows).From(dynamics).As(&CollisionDamper::Bound);
  Compute(distance).From(dynamics).As(&CollisionDamper::Measure);
}

PairDistances CollisionDamper::Measure(const RobotDynamics& d) const {
  return geometry_.Distances(d, delta_);
}

void CollisionDamper::Bound(AccelerationRows& out, const RobotDynamics& d) const {
  CollisionGeometry::Placement placement;
  geometry_.Place(d, placement);
  // What least_distance ≥ d_s + (A + λ v)/k asks of the centres of two parts is a sum of theirs.
  const double k = -damper_.Least(1, 0), lambda = -damper_.Least(0, 1);
  std::array<double, 2 * kMaxCollisionPairs> reach;
  for (std::size_t i = 0; i < geometry_.parts().size(); ++i) {
    const CollisionGeometry::Part& part = geometry_.parts()[i];
    reach[i] = part.shape.extent + part.shape.radius + 0.5 * (d_s_ + delta_ + A_ / k);
    if (part.body < 0) continue;
    const BodyMotion& B = d.body[At(part.body)];
    reach[i] += lambda / k *
                (VelocityAt(B, placement[i].center).norm() + B.omega.norm() * part.shape.extent);
  }

  out.A.setZero();
  out.lower.setConstant(-std::numeric_limits<double>::infinity());
  const std::span<const Body> bodies = model_.bodies();
  for (int i = 0; i < geometry_.size(); ++i) {
    const CollisionGeometry::Pair& pair = geometry_.pairs()[At(i)];
    const PlacedShape &a = placement[At(pair.a)], &b = placement[At(pair.b)];
    const double both = reach[At(pair.a)] + reach[At(pair.b)];
    if ((a.center - b.center).squaredNorm() >= both * both) continue;

    const Proximity p = Closest(a, b, delta_);
    int body_a = geometry_.part(pair.a).body, body_b = geometry_.part(pair.b).body;
    const BodyMotion &A = MotionOfBody(d, body_a), &B = MotionOfBody(d, body_b);
    const Vector3d w = VelocityAt(A, p.a) - VelocityAt(B, p.b);
    const double edot = p.normal.dot(w);
    const double least = damper_.Least(p.distance - d_s_, edot);
    if (least <= -A_) continue;

    // A joint that carries both does not change e: x_a − x_b is along n. Parents come first.
    const Vector3d moment_a = p.a.cross(p.normal), moment_b = p.b.cross(p.normal);
    double squares = 0;
    while (body_a != body_b) {
      const bool of_a_now = body_a > body_b;
      int& body = of_a_now ? body_a : body_b;
      const BodyMotion& motion = d.body[At(body)];
      const Vector3d z = motion.rotation.col(2);
      const double effect =
          bodies[At(body)].revolute
              ? z.dot((of_a_now ? moment_a : moment_b) - motion.position.cross(p.normal))
              : z.dot(p.normal);
      out.A(i, bodies[At(body)].joint) = of_a_now ? effect : -effect;
      squares += effect * effect;
      body = bodies[At(body)].parent;
    }
    if (squares < kNoEffect * kNoEffect) continue;
    const bool a_is_larger = a.shape->extent > b.shape->extent;
    const Vector3d c = (a_is_larger ? A : B).omega.cross(p.normal);
    const double beta = p.normal.dot(AccelerationAt(A, p.a) - AccelerationAt(B, p.b)) +
                        2 * w.dot(c) - p.normal.dot(p.a - p.b) * c.squaredNorm();
    out.lower(i) = least - beta;
  }
}

}  // namespace pliant
