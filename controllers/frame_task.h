#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/controllers/compliance.h"
#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// A frame B follows a target in a reference A, the world or a link that moves itself, with its
/// whole pose or with what a basis selects of it:
///
///   e = [log(R R°ᵀ); p − p°] of X_AB and X_AB°, in A's axes, angular part first
///   u = S e                        in the axes of A
///   u = S diag(Rᵀ, Rᵀ) e           in the axes of B
///   ü* = −λ₁ u̇ − λ₂ u                                                          (EC 3)
///   w ‖ A q̈ʳ + c − ü* − (Γ + Y Λ) A q̈_e ‖²                                      (EC 4, 9)
///
/// S is m×6 with orthonormal rows; λ₁, λ₂ per row. ü = A q̈ + c: with J, J̇ q̇ those of the motion of
/// B in A, [ω; v] its twist and x = p − p°,
///
///   axes of A:  u̇ = S (V − V°),   A = S J,   c = S (J̇ q̇ − V̇°)
///   axes of B:  u̇ = S [Rᵀ(ω − ω°); Rᵀ(ẋ − ω × x)],   A = S [Rᵀ J_ω; Rᵀ(J_v + [x]× J_ω)],
///               c = S [Rᵀ(α − α° + ω × ω°); Rᵀ(ẍ − 2 ω × ẋ + ω × (ω × x) − α × x)] at q̈ = 0
///
/// u̇ is the rate of u for positions. Away from 0 it is not that of log(R R°ᵀ), in neither axes, but
/// it has eᵀ(ω − ω°) = d/dt ½‖e‖² up to half a turn, and ü is always the rate of u̇. So with the
/// same λ₁, λ₂ for all axes of a whole orientation ½λ₂‖u‖² + ½‖u̇‖² falls at λ₁‖u̇‖² where nothing
/// hinders the task. Of an orientation of which S leaves a part free this holds as that part
/// vanishes, with one exception:
///
/// Pointing. Where S, in the axes of B, leaves one turn free, about a in B, the error is the
/// shortest turn that takes R° a to R a, however far B has turned about a. It lies in the plane
/// that S selects, and what is said of the whole orientation holds.
///
/// Γ says how the task gives way to what pushes: 0 not at all, I as the arm's own inertia would,
/// any symmetric positive semi-definite matrix in between and beyond. Y is instead a wanted
/// mobility, the inverse of a virtual inertia: the push accelerates u by Y per unit of the force
/// that does the same work, whatever the arm's own inertia Λ = (A M⁻¹ Aᵀ)⁻¹. Y Λ is not symmetric,
/// and is not made so. Λ is exact while its eigenvalues are at most half of its limit L. Beyond
/// that, with k < k₀ = 2/L an eigenvalue of A M⁻¹ Aᵀ, 1/k is replaced by (2 k₀ − k)/k₀²: towards a
/// singularity Λ stays below L, and what it makes of a push in the lost direction fades smoothly to
/// zero.
///
/// Source: Celerier et al. 2025 (EC), with J q̈_e where the paper prints Jᵀ q̈_e.
class FrameTask final : public Block {
 public:
  enum class Part { Pose, Orientation, Position };
  friend const std::vector<std::string>& Words(Part) {
    static const std::vector<std::string> words{"pose", "orientation", "position"};
    return words;
  }

  enum class Axes { Reference, Frame };
  friend const std::vector<std::string>& Words(Axes) {
    static const std::vector<std::string> words{"reference", "frame"};
    return words;
  }

  struct Options {
    RobotModel model;
    std::string frame;                            ///< B, name of a link
    std::optional<std::string> relative_to = {};  ///< A, name of a link; none: the world
    Part part = Part::Pose;
    Axes axes = Axes::Reference;  ///< in which S selects
    /// S: m×6 of a pose, m×3 of an orientation or a position; one row may stand as a column. Empty:
    /// all of the part.
    TaskMatrix basis = {};
    Pose target = {};            ///< X_AB°, until one is connected
    TaskVector stiffness = {};   ///< λ₂ [1/s²], each ≥ 0
    TaskVector damping = {};     ///< λ₁ [1/s], each ≥ 0
    double weight = 1;           ///< w > 0
    TaskMatrix compliance = {};  ///< Γ; empty: 0; a number γ: γ I; a column: the diagonal
    TaskMatrix mobility = {};    ///< Y [1/kg, 1/(kg·m²)], in the same forms
    /// Axes in which Γ and Y are given here, as columns in those of the task, for tasks of 3 or 6
    /// rows. The inputs have the axes of the task.
    Eigen::Matrix3d compliance_axes = Eigen::Matrix3d::Identity();
    double inertia_limit = 200;  ///< L [kg, kg·m²]

    template <class F>
    void Parameters(F&& f) {
      f("frame", frame);
      f("relative_to", relative_to);
      f("part", part);
      f("axes", axes);
      f("basis", basis);
      f("stiffness", stiffness, "1/s²", kNotNegative);
      f("damping", damping, "1/s", kNotNegative);
      f("weight", weight, "", kPositive);
      f("compliance", compliance);
      f("mobility", mobility);
      f("compliance_axes", compliance_axes);
      f("inertia_limit", inertia_limit, "kg", kPositive);
    }
  };

  explicit FrameTask(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointAcceleration> external_acceleration;  ///< q̈_e; 0 if not connected
  Input<Pose> target;
  Input<Twist> target_twist;         ///< V°, in A
  Input<Twist> target_acceleration;  ///< V̇°, in A [rad/s²; m/s²]
  Input<TaskVector> stiffness, damping;
  Input<double> weight;
  Input<TaskMatrix> compliance, mobility;
  Output<FrameDynamics> frame;    ///< of B in A, in A's axes
  Output<TaskVector> error;       ///< u [rad, m]
  Output<TaskVector> error_rate;  ///< u̇ [rad/s, m/s]
  Output<Objective> objective;

 private:
  using Basis = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, 6, 6>;

  FrameTask(const Options& o, const Basis& S);
  static Basis BasisOf(const Options& o);
  static int RowsOf(const Options& o, const Basis& S);
  FrameDynamics Find(const RobotDynamics& d) const;
  TaskVector Error(const FrameDynamics& now, const Pose& X) const;
  TaskVector ErrorRate(const FrameDynamics& now, const Pose& X, const Twist& V) const;
  void Want(Objective& out, const RobotDynamics& d, const FrameDynamics& now,
            const JointAcceleration& qdd_e, const Pose& X, const Twist& V, const TaskVector& u,
            const TaskVector& udot, const Twist& feedforward, const TaskVector& k,
            const TaskVector& c, double w, const TaskMatrix& gamma, const TaskMatrix& Y) const;
  TaskVector Selected(const Vector6& x) const;
  void SelectInFrame(Objective& out, const FrameDynamics& now, const Pose& X, const Twist& V,
                     const Twist& feedforward) const;
  TaskVector AccelerationBy(const TaskMatrix& Y, const RobotDynamics& d, const Objective& out,
                            const TaskVector& pushed) const;

  const RobotModel model_;
  const int link_, reference_;  // −1: the world
  const Axes axes_;
  const Basis S_;  // empty: rows_ from first_ on
  const int first_, rows_;
  const Eigen::Vector3d free_;  // a; 0: none
  const double k0_;
};

}  // namespace pliant
