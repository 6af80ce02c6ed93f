#pragma once

#include <vector>

#include "pliant/controllers/objective.h"
#include "pliant/controllers/velocity_damper.h"
#include "pliant/plants/collision_geometry.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Keeps links apart from one another and from obstacles, by a second-order velocity damper for
/// each pair of shapes. With e the softened distance, n the normal from b to a, and x_a, x_b the
/// closest points as points of their bodies (collision_distance.h), w = ẋ_a − ẋ_b, z = nᵀ(x_a −
/// x_b):
///
///   ė = nᵀ(J_a − J_b) q̇
///   ë = nᵀ(J_a − J_b) q̈ + β + κ,   β = nᵀ(J̇_a − J̇_b) q̇ + 2 wᵀc − z ‖c‖²,   c = ω × n
///
///   nᵀ(J_a − J_b) q̈ ≥ −λ ė − λ²/(4M²) (e − d_s) − β                                     (EC 24)
///
/// is a row of `rows`. ω is the rate of rotation of the body with the larger core, so that the
/// first two parts of ë are how one point accelerates along n as seen from that body. κ is what e
/// gains as n turns with that point, and loses as the closest points slide. It is left out, so that
/// rows and bounds do not jump. With w' = w − n nᵀ w − z c, Ω the rate of rotation of one body as
/// seen from the other and R the smaller extent of the cores,
///
///   −Ω² R²/δ ≤ κ ≤ ‖w'‖²/z
///
/// If one core is a point R = 0, and to leave out κ is on the safe side. Otherwise κ < 0 only where
/// bodies turn with the points sliding on edges or faces, and it is as large as that only while
/// parallel ones turn through 2 δ/R; so what is left out takes at most 2 Ω R of ė there, and 2 Ω
/// R/λ of e.
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
