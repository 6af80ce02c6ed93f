#pragma once

#include "pliant/controllers/objective.h"
#include "pliant/controllers/qp_solver.h"
#include "pliant/systems/block.h"

namespace pliant {

/// How a tick of ComplianceQp ended.
struct ComplianceQpReport {
  using Space = Joints;
  static constexpr Quantity quantity{"compliance QP report", ""};

  enum class Outcome : std::uint8_t {
    Solved,    ///< all limits hold
    Relaxed,   ///< acceleration bounds are exceeded by `slack`, torque limits hold
    Fallback,  ///< no solution: damped gravity compensation
  };

  Outcome outcome = Outcome::Fallback;
  QpStatus status = QpStatus::InvalidData;  ///< of the problem with all limits
  int iterations = 0;
  /// What contradicted: a Bound is an acceleration bound, a Row a torque limit, by joint.
  QpLimits conflict;
  PerJoint slack;  ///< by how much q̈_d is outside of the acceleration bounds [rad/s²]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("outcome", outcome, "");
    f("status", status, "");
    f("iterations", iterations, "");
    f("conflict", conflict, "");
    f("slack", slack, "rad/s²");
  }
};

/// The mid-level controller: the joint acceleration that serves all tasks best inside all limits,
/// and the torque that brings it about whatever pushes the arm:
///
///   min Σ_k w_k ‖A_k q̈ʳ − b_k‖²                                                       (EC 9)
///   s.t. τ⁻ ≤ M q̈ʳ + C q̇ + g − τ̂_e ≤ τ⁺                                            (EC 10)
///        bounds of every damper on q̈ʳ                                            (EC 23, 24)
///   τ_d = M q̈_d + C q̇ + g − τ̂_e                                                      (EC 8)
///
/// sampled every h. One objective must have full rank, as a posture task has, so that the problem
/// is strictly convex. Torque limits always hold. Where acceleration bounds contradict them or each
/// other, the bounds give way before the tasks count: s is added,
///
///   min Σ_k w_k ‖A_k q̈ʳ − b_k‖² + ρ ‖s‖²,   lower − s ≤ q̈ʳ ≤ upper + s
///   ρ = 10⁴ tr Σ_k w_k A_kᵀ A_k
///
/// Without any solution the arm gets g − d q̇ inside the torque limits (zero where that is no
/// number). Both are reported.
///
/// Source: Celerier et al. 2025 (EC).
class ComplianceQp final : public Block {
 public:
  struct Options {
    RobotModel model;
    Duration period;
    double fallback_damping = 5;  ///< d [N·m·s/rad], ≥ 0
  };

  explicit ComplianceQp(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> external_torque;  ///< τ̂_e; 0 if not connected
  Input<JointTorque> torque_limit;     ///< τ⁺ = −τ⁻; the model's if not connected
  InputList<Objective> objectives;
  InputList<AccelerationBounds> bounds;
  Output<JointTorque> torque;              ///< τ_d
  Output<JointAcceleration> acceleration;  ///< q̈_d
  Output<ComplianceQpReport> report;

 private:
  /// What a tick leaves; the active set starts the next one.
  struct Solution {
    JointAcceleration qdd;
    JointTorque torque;
    ComplianceQpReport report;
    QpLimits active;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("qdd", qdd, "rad/s²");
      f("torque", torque, "N·m");
      f("report", report, "");
      f("active", active, "");
    }
  };
  struct Workspace {
    QpProblem problem, relaxed;
    QpWorkspace solver;
    QpSolution solution;
  };

  void Solve(Solution& out, const Solution& last, Workspace& w, const RobotDynamics& d,
             const JointTorque& tau_e, const JointTorque& limit, const Joined<Objective>& terms,
             const Joined<AccelerationBounds>& dampers) const;

  JointTorque Fallback(const RobotDynamics& d, const JointTorque& limit) const;

  const double d_;
  Output<Solution> solution_;
  Scratch<Workspace> work_;
};

}  // namespace pliant
