#pragma once

#include <vector>

#include "pliant/controllers/objective.h"
#include "pliant/controllers/velocity_damper.h"
#include "pliant/plants/collision_geometry.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Keeps links apart from one another and from obstacles, by a second-order velocity damper for
/// each pair of shapes. With e the softened distance (collision_distance.h), n the normal from b to
/// a, and x_a, x_b the closest points as points of their bodies:
///
///   ė = nᵀ(J_a − J_b) q̇
///   ë = nᵀ(J_a − J_b) q̈ + nᵀ(J̇_a − J̇_b) q̇ + κ
///
///   nᵀ(J_a − J_b) q̈ ≥ −λ ė − λ²/(4M²) (e − d_s) − nᵀ(J̇_a − J̇_b) q̇                    (EC 24)
///
/// is a row of `rows`. κ is left out, so that rows and bounds do not jump. It is
///
///   κ = ‖w_⊥‖²/‖x_a − x_b‖ − gᵀ H⁻¹ g
///
/// with w_⊥ the part normal to n of the relative velocity w of the points. The first term is the
/// bending of the line between fixed points: without it, rows are on the safe side. The second is
/// what e loses as the closest points slide: H > 0 is the second derivative of what e is the
/// minimum of, g how fast its gradient changes. It takes back the first where a point goes along a
/// plane or a line. With ω the rate of rotation of one body as seen from the other and R the
/// smaller extent of the cores,
///
///   κ ≥ −ω² R²/δ
///
/// and that only while parallel edges or faces turn through 2 δ/R, so ė loses at most 2 ω R, and e
/// at most 2 ω R/λ, by what is left out. Elsewhere κ is at least of the order of −ω² ‖x_a − x_b‖.
///
/// A row stays infinite where no q̈ that closes the pair with ë ≥ −A violates it: where the bound on
/// ë is below −A. For most pairs the spheres around them show that,
///
///   λ²/(4M²) (e° − d_s) ≥ A + λ v°     e° ≤ e, v° ≥ −ė
///
/// so at rest rows reach d_s + 4M² A/λ² far: 0.175 m with the figures below. A row also stays
/// infinite where no joint changes the distance.
///
/// What sets out at rest with e ≥ d_s and keeps to its row keeps e ≥ d_s, less what κ takes; the
/// true distance is not less than e. What e and n are when cores overlap, says
/// collision_distance.h.
///
/// Source: Celerier et al. 2025 (EC); safety distance of their software.
class CollisionDamper final : public Block {
 public:
  struct Options {
    RobotModel model;
    CollisionPairs pairs = {};
    std::vector<Obstacle> obstacles = {};
    VelocityDamper damper = {};
    double safety_distance = 0.015;     ///< d_s [m]
    double softening = 5e-4;            ///< δ [m]
    double closing_acceleration = 100;  ///< A [m/s²]
    int priority = 2;                   ///< of the rows

    template <class F>
    void Parameters(F&& f) {
      f("pairs", pairs);
      f("obstacles", obstacles);
      f("damper", damper);
      f("safety_distance", safety_distance, "m", kNotNegative);
      f("softening", softening, "m", kPositive);
      f("closing_acceleration", closing_acceleration, "m/s²", kPositive);
      f("priority", priority, "", Range{.least = 1});
    }
  };

  explicit CollisionDamper(const Options& o);

  Input<RobotDynamics> dynamics;
  Output<AccelerationRows> rows;   ///< one for each pair
  Output<PairDistances> distance;  ///< e of each pair, near or far

  const CollisionGeometry& geometry() const { return geometry_; }

 private:
  CollisionDamper(const Options& o, CollisionGeometry geometry);

  void Bound(AccelerationRows& out, const RobotDynamics& d) const;
  PairDistances Measure(const RobotDynamics& d) const;

  const CollisionGeometry geometry_;
  const RobotModel model_;
  const VelocityDamper damper_;
  const double d_s_, delta_, A_;
};

}  // namespace pliant
