#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// One row per joint, up to 6 columns: the inverse of a Jacobian.
using JacobianInverse = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, kMaxJoints, 6>;

/// Joint motions that do not move a frame, and those that move it with the least ‖q̇‖.
struct NullSpace {
  using Space = Joints;
  static constexpr Quantity quantity{"null space", ""};

  NullSpace() = default;
  /// Of n joints of which nothing is known yet: all of them are free.
  explicit NullSpace(int n)
      : projector{JointMatrix::Identity(n, n)}, inverse{JacobianInverse::Zero(n, 6)} {}

  JointMatrix projector;      ///< N
  JacobianInverse inverse;    ///< J†
  double least_singular = 0;  ///< smallest singular value of J, in rad, m and s

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("projector", projector, "");
    f("inverse", inverse, "");
    f("least_singular", least_singular, "");
  }
};

/// The projector on the null space of a frame's Jacobian, with the Moore–Penrose inverse:
///
///   N = I − J† J,   J† = Jᵀ (J Jᵀ)⁻¹ = Σ_i v_i u_iᵀ/σ_i
///
/// N is symmetric and N² = N, J N = 0, N J† = 0: of q̇_d = J† ẋ_d nothing is left in the null space.
/// So is what moves: torques are projected as velocities are, and N τ may push the tool by
/// J M⁻¹ N τ; for torques that do not, NullSpaceReaction has the projector of M.
///
/// Towards a singularity a direction i with σ_i < σ₀ is damped:
///
///   1/σ_i → σ_i/(σ_i² + λ_i²),   λ_i² = ¼ (σ₀² − σ_i²)
///
/// so no gain of J† exceeds 2/(√3 σ₀), and N has along v_i the eigenvalue (σ₀² − σ_i²)/(σ₀² +
/// 3σ_i²), from 0 at σ₀ to 1 where the direction is lost: N stays symmetric, 0 ⪯ N ⪯ I and
/// continuous, and there N² ≠ N. σ mixes rad and m: where nothing is damped N does not depend on
/// the unit of length; J† does.
///
/// Source: Maciejewski & Klein, Int. J. Robotics Research 4(3), 1985, for one direction at a time.
class NullSpaceProjector final : public Block {
 public:
  struct Options {
    Joints joints;
    double damped_below = 0.05;  ///< σ₀ > 0
  };

  explicit NullSpaceProjector(const Options& o);

  Input<FrameDynamics> frame{this, "frame"};
  Output<NullSpace> null_space;
  Output<double> least_singular{this, "least_singular"};

 private:
  void Project(NullSpace& out, const FrameDynamics& now) const;

  const double s0_;
};

}  // namespace pliant
