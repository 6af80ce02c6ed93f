#pragma once

#include <array>

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
    Relaxed,   ///< solved again with bounds and rows that may be exceeded; torque limits hold
    Fallback,  ///< no solution: damped gravity compensation
  };

  Outcome outcome = Outcome::Fallback;
  QpStatus status = QpStatus::InvalidData;  ///< of the problem with all limits
  int iterations = 0;
  int relaxed_priority = 0;  ///< of what gave way the most important; 0: nothing
  /// Of the limits, > 0 at a lower one, < 0 at an upper one, 0 where it does not act.
  PerJoint torque_multiplier, bound_multiplier;
  AccelerationRows::Vector row_multiplier;
  /// By how much a limit is exceeded: a bound [rad/s²], a row.
  PerJoint bound_slack;
  AccelerationRows::Vector row_slack;

  static ComplianceQpReport None(int joints, int rows);

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("outcome", outcome, "");
    f("status", status, "");
    f("iterations", iterations, "");
    f("relaxed_priority", relaxed_priority, "");
    f("torque_multiplier", torque_multiplier, "");
    f("bound_multiplier", bound_multiplier, "");
    f("row_multiplier", row_multiplier, "");
    f("bound_slack", bound_slack, "rad/s²");
    f("row_slack", row_slack, "");
  }
};

/// The mid-level controller: the joint acceleration that serves all tasks best inside all limits,
/// and the torque that brings it about whatever pushes the arm:
///
///   min Σ_k w_k ‖A_k q̈ʳ − b_k‖²                                                       (EC 9)
///   s.t. τ⁻ ≤ M q̈ʳ + C q̇ + g − τ̂_e ≤ τ⁺                                            (EC 10)
///        bounds of every damper on q̈ʳ                                            (EC 19, 24)
///        lower ≤ A q̈ʳ ≤ upper of all rows
///   τ_d = M q̈_d + C q̇ + g − τ̂_e                                                      (EC 8)
///
/// sampled every h. One objective must have full rank, as a posture task has, so that the problem
/// is strictly convex.
///
/// Torque limits always hold. Where not everything else can, it gives way in order of priority: the
/// bounds have 1, rows have their own. From 1 upwards each priority in turn is exceeded by as
/// little as those before it allow, in least squares,
///
///   min ‖q̈ − q̈₀‖² + 10⁶ ‖s‖²,   lower ≤ A q̈ + s ≤ upper,
///
/// first with q̈₀ = 0, then with q̈₀ the answer, which leaves no more of s than must be; a limit with
/// lower > upper taken at their middle; what it must be exceeded by is then added to it. Last, the
/// tasks get what freedom remains.
///
/// Of one priority as many give way together as 64 − n; where there are more, later rows go first.
///
/// Without any solution the arm gets g − d q̇ inside the torque limits (zero where that is no
/// number), and q̈_d is what that does to an arm that nothing pushes. Both are reported.
///
/// Source: Celerier et al. 2025 (EC).
class ComplianceQp final : public Block {
 public:
  struct Options {
    RobotModel model;
    Duration period;
    int rows = 0;                 ///< of all that joins `rows`; with other numbers it falls back
    double fallback_damping = 5;  ///< d [N·m·s/rad], ≥ 0
  };

  explicit ComplianceQp(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> external_torque;  ///< τ̂_e; 0 if not connected
  Input<JointTorque> torque_limit;     ///< τ⁺ = −τ⁻; the model's if not connected
  InputList<Objective> objectives;
  InputList<AccelerationBounds> bounds;
  InputList<AccelerationRows> rows;
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
    QpLimits none;
    PerJoint feasible;  // inside all limits as far as they have been moved
  };

  void Solve(Solution& out, const Solution& last, Workspace& w, const RobotDynamics& d,
             const JointTorque& tau_e, const JointTorque& limit, const Joined<Objective>& terms,
             const Joined<AccelerationBounds>& dampers, const Joined<AccelerationRows>& rows) const;
  /// The problem with all limits; false if there are other rows than it has room for.
  bool Write(Workspace& w, const RobotDynamics& d, const JointTorque& limit,
             const JointTorque& bias, const Joined<Objective>& terms,
             const Joined<AccelerationBounds>& dampers, const Joined<AccelerationRows>& rows) const;
  /// Moves the limits of the problem that cannot hold, priority by priority. The first that had to
  /// move; 0 if none had.
  int Relax(Workspace& w, const Joined<AccelerationRows>& rows) const;
  /// Moves `count` limits, while others are kept; whether it had to.
  using Flags = std::array<bool, kMaxJoints + AccelerationRows::kMaxRows>;
  bool Give(Workspace& w, const Flags& kept, const Flags& giving, int count) const;

  JointTorque Fallback(const RobotDynamics& d, const JointTorque& limit) const;

  const int n_, rows_;
  const double d_;
  Output<Solution> solution_;
  Scratch<Workspace> work_;
};

}  // namespace pliant
