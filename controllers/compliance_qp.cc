#include "pliant/controllers/compliance_qp.h"

#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The larger and the smaller of two numbers; not a number if one of them is none.
constexpr auto kLarger = [](double a, double b) { return std::isnan(a) || a > b ? a : b; };
constexpr auto kSmaller = [](double a, double b) { return std::isnan(a) || a < b ? a : b; };

/// x inside ∓limit.
PerJoint Clamped(const PerJoint& x, const PerJoint& limit) {
  return x.binaryExpr(limit, [](double a, double b) { return kSmaller(kLarger(a, -b), b); });
}

/// H += w Aᵀ A, lower triangle, and g −= w Aᵀ b, for a term of `Rows` rows.
template <int Rows>
void Add(const Objective& term, QpProblem& qp) {
  using Matrix = Eigen::Matrix<double, Rows, Eigen::Dynamic, Eigen::ColMajor,
                               Rows == Eigen::Dynamic ? Objective::kMaxRows : Rows, kMaxJoints>;
  const Eigen::Map<const Matrix> A(term.A.data(), term.A.rows(), term.A.cols());
  const Eigen::Map<const Eigen::Matrix<double, Rows, 1>> b(term.b.data(), term.b.size());
  for (Eigen::Index j = 0; j < A.cols(); ++j) {
    for (Eigen::Index i = j; i < A.cols(); ++i) qp.H(i, j) += term.weight * A.col(i).dot(A.col(j));
    qp.g(j) -= term.weight * A.col(j).dot(b);
  }
}

// The compiler knows the usual sizes: a position, a pose, seven joints.
void Add(const Objective& term, QpProblem& qp) {
  switch (term.b.size()) {
    case 3:
      return Add<3>(term, qp);
    case 6:
      return Add<6>(term, qp);
    case 7:
      return Add<7>(term, qp);
    default:
      return Add<Eigen::Dynamic>(term, qp);
  }
}

/// The problem of the class comment, in (q̈, s) with a multiple of s².
void WriteRelaxed(const QpProblem& qp, QpProblem& relaxed) {
  const Eigen::Index n = qp.variables();
  relaxed.H.setZero();
  relaxed.H.topLeftCorner(n, n) = qp.H;
  relaxed.H.diagonal().tail(n).setConstant(1e4 * qp.H.trace());
  relaxed.g << qp.g, PerJoint::Zero(n);
  relaxed.A.setZero();
  relaxed.A.topLeftCorner(n, n) = qp.A;
  relaxed.A.block(n, 0, n, n).setIdentity();
  relaxed.A.block(n, n, n, n).setIdentity();
  relaxed.A.block(2 * n, 0, n, n).setIdentity();
  relaxed.A.block(2 * n, n, n, n).diagonal().setConstant(-1);
  relaxed.lower << qp.lower, qp.x_lower, PerJoint::Constant(n, -kInfinity);
  relaxed.upper << qp.upper, PerJoint::Constant(n, kInfinity), qp.x_upper;
}

}  // namespace

ComplianceQp::ComplianceQp(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      external_torque{this, "external_torque", o.model.joints(),
                      JointTorque::Zero(o.model.joints())},
      torque_limit{this, "torque_limit", o.model.joints(), o.model.effort_limit()},
      objectives{this, "objectives", o.model.joints()},
      bounds{this, "bounds", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      report{this,
             "report",
             o.model.joints(),
             {.conflict = {}, .slack = PerJoint::Zero(o.model.size())}},
      d_{o.fallback_damping},
      solution_{this,
                "solution",
                {},
                {.qdd = JointAcceleration::Zero(o.model.joints()),
                 .torque = JointTorque::Zero(o.model.joints()),
                 .report = {.conflict = {}, .slack = PerJoint::Zero(o.model.size())},
                 .active = {}}},
      work_{this, "work",
            Workspace{.problem = QpProblem(o.model.size(), o.model.size()),
                      .relaxed = QpProblem(2 * o.model.size(), 3 * o.model.size()),
                      .solver = {},
                      .solution = {}}} {
  Require(o.fallback_damping >= 0 && std::isfinite(o.fallback_damping),
          "fallback_damping must be finite and >= 0", o.fallback_damping);
  Every(o.period)
      .Compute(solution_)
      .From(solution_, work_, dynamics, external_torque, torque_limit, objectives, bounds)
      .As(&ComplianceQp::Solve);
  Compute(torque).From(solution_).As([](const Solution& s) { return s.torque; });
  Compute(acceleration).From(solution_).As([](const Solution& s) { return s.qdd; });
  Compute(report).From(solution_).As([](const Solution& s) { return s.report; });
}

void ComplianceQp::Solve(Solution& out, const Solution& last, Workspace& w, const RobotDynamics& d,
                         const JointTorque& tau_e, const JointTorque& limit,
                         const Joined<Objective>& terms,
                         const Joined<AccelerationBounds>& dampers) const {
  using Outcome = ComplianceQpReport::Outcome;
  QpProblem& qp = w.problem;
  qp.H.setZero();
  qp.g.setZero();
  for (int k = 0; k < terms.size(); ++k) Add(terms[k], qp);
  qp.x_lower.setConstant(-kInfinity);
  qp.x_upper.setConstant(kInfinity);
  for (int k = 0; k < dampers.size(); ++k) {
    qp.x_lower = qp.x_lower.binaryExpr(dampers[k].lower, kLarger);
    qp.x_upper = qp.x_upper.binaryExpr(dampers[k].upper, kSmaller);
  }
  const JointTorque bias = d.coriolis + d.gravity - tau_e;
  qp.A = d.M;
  qp.lower = -limit - bias;
  qp.upper = limit - bias;

  out.active = last.active;
  ComplianceQpReport& r = out.report;
  r.outcome = Outcome::Solved;
  r.status = pliant::Solve(qp, w.solver, out.active, w.solution);
  r.iterations = w.solution.iterations;
  r.conflict = w.solution.conflict;
  r.slack.setZero();
  QpStatus status = r.status;
  if (status == QpStatus::Infeasible || status == QpStatus::IterationLimit) {
    r.outcome = Outcome::Relaxed;
    out.active.clear();
    WriteRelaxed(qp, w.relaxed);
    QpLimits active;
    status = pliant::Solve(w.relaxed, w.solver, active, w.solution);
  }
  if (status != QpStatus::Solved) {
    r.outcome = Outcome::Fallback;
    out.active.clear();
    out.qdd.setZero();
    out.torque = Fallback(d, limit);
    return;
  }
  out.qdd = w.solution.x.head(out.qdd.size());
  if (r.outcome == Outcome::Relaxed)
    r.slack = (qp.x_lower - out.qdd).cwiseMax(out.qdd - qp.x_upper).cwiseMax(0);
  // The solver holds the rows to its round-off; the limit itself is hard.
  const JointTorque torque = d.M.lazyProduct(out.qdd) + bias;
  out.torque = Clamped(torque, limit);
}

JointTorque ComplianceQp::Fallback(const RobotDynamics& d, const JointTorque& limit) const {
  const JointTorque torque = d.gravity - d_ * d.v;
  return Clamped(torque, limit).unaryExpr([](double x) { return std::isfinite(x) ? x : 0; });
}

}  // namespace pliant
