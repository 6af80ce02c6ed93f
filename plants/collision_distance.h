#pragma once

#include <Eigen/Core>

#include "pliant/plants/collision_shape.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// Where a shape is: `rotation` and `shape` are referred to, and must stay.
struct PlacedShape {
  PlacedShape() = default;  ///< nowhere, and nothing is initialised
  /// In a frame at `position` with these axes.
  PlacedShape(const CollisionShape& s, const Eigen::Matrix3d& R, const Eigen::Vector3d& position)
      : shape{&s}, rotation{&R}, center{position + R * s.center}, half{R * s.half} {}

  const CollisionShape* shape;
  const Eigen::Matrix3d* rotation;
  Eigen::Vector3d center, half;  ///< of the core
};

/// How far two shapes are apart.
struct Proximity {
  double distance;         ///< e [m]; below zero in penetration
  Eigen::Vector3d normal;  ///< n, from b to a, of length 1
  Eigen::Vector3d a, b;    ///< the closest points x_a, x_b of the cores; x_a − x_b is along n [m]
};

/// The distance of two shapes, softened by δ so that its gradient does not jump:
///
///   e = min ‖x_a − x_b‖ + δ (‖x_a − c_a‖²/(2 R_a²) + ‖x_b − c_b‖²/(2 R_b²) − 1) − r_a − r_b
///
/// over the points x_a, x_b of the cores, with their centres c, extents R and radii r. The term in
/// brackets is between −1 and 0, so with the true distance d
///
///   d − δ ≤ e ≤ d
///
/// and δ = 0 is the true one. For δ > 0 the minimum is at one pair of points only. As bodies move,
/// x_a and x_b are material points in the derivative of e, for the rest is stationary and ‖x − c‖
/// does not change with a motion:
///
///   ė = nᵀ(v_a(x_a) − v_b(x_b)),   n = (x_a − x_b)/‖x_a − x_b‖
///
/// exactly. Where cores are apart, ‖x_a − x_b‖ = z > 0, e is continuously differentiable, and n and
/// the points do not jump: those of parallel segments, edges or faces, which for δ = 0 are anywhere
/// on them, are at the middle of them. Let R = R_a ≤ R_b, let a turn by θ, as seen from b, and the
/// material point of a that was at x_a move by w. Then
///
///   ‖Δx_a‖ ≤ s = R²/δ (θ + w/z),   ‖Δx_b‖ ≤ w + s,   ‖Δn‖ ≤ (w + s)/z
///
/// each relative to its body, n as seen from b, z: the least on the way. So (1 + R²/(δ z)) is what
/// a jump is spread by. If one core is a point there is nothing to soften; δ is taken for 0, and s
/// is 0 for it.
///
/// The radii keep cores apart while surfaces penetrate. When cores touch or overlap, their depth is
/// that of the least translation that parts them: e = −depth − δ − r_a − r_b. Then n is the
/// direction of that translation of a, one of those normal to a face of either, or to an edge of
/// each; n and the points jump where another becomes the least, e does not, and steps by up to δ
/// where cores begin to touch. For crossing segments n is normal to both and points to the side on
/// which c_a is.
///
/// No heap, no exceptions. Source of segments: Ericson, Real-Time Collision Detection, 2005, 5.1.9,
/// with δ d added to the diagonal; of polytopes: Wolfe, Finding the nearest point in a polytope,
/// Math. Programming 11, 1976; of depths: separating axes, Ericson, 5.2.1.
Proximity Closest(const PlacedShape& a, const PlacedShape& b, double softening = 0);

}  // namespace pliant
