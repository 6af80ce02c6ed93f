#include "pliant/controllers/compliance_qp.h"

#include <algorithm>
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

/// H += w Aᵀ A, lower triangle, and g −= w Aᵀ b, for a term of `Rows` rows: a position, a pose.
/// Joints that do not move its frame are left out.
template <int Rows>
void AddRows(const Objective& term, QpProblem& qp) {
  const Eigen::Map<const Eigen::Matrix<double, Rows, Eigen::Dynamic>> A(term.A.data(), Rows,
                                                                        term.A.cols());
  const Eigen::Map<const Eigen::Matrix<double, Rows, 1>> b(term.b.data());
  std::array<int, kMaxJoints> joint;
  int count = 0;
  for (int j = 0; j < A.cols(); ++j)
    if (!(A.col(j).squaredNorm() == 0)) joint[count++] = j;
  for (int q = 0; q < count; ++q) {
    const int j = joint[q];
    const Eigen::Matrix<double, Rows, 1> a = term.weight * A.col(j);
    qp.g(j) -= a.dot(b);
    for (int p = q; p < count; ++p) qp.H(joint[p], j) += a.dot(A.col(joint[p]));
  }
}

/// The same for any term, row by row without its zeros: of a posture each row is about one joint.
void AddSparseRows(const Objective& term, QpProblem& qp) {
  std::array<int, kMaxJoints> joint;
  for (int k = 0; k < term.A.rows(); ++k) {
    int count = 0;
    for (int j = 0; j < term.A.cols(); ++j) {
      joint[count] = j;
      count += !(term.A(k, j) == 0);
    }
    for (int q = 0; q < count; ++q) {
      const int j = joint[q];
      const double a = term.weight * term.A(k, j);
      qp.g(j) -= a * term.b(k);
      for (int p = q; p < count; ++p) qp.H(joint[p], j) += a * term.A(k, joint[p]);
    }
  }
}

void Add(const Objective& term, QpProblem& qp) {
  if (term.A.rows() == 6) return AddRows<6>(term, qp);
  if (term.A.rows() == 3) return AddRows<3>(term, qp);
  AddSparseRows(term, qp);
}

/// Of the limits on q̈: j < n is the bound of joint j, from n on j is a row.
struct Limit {
  double &lower, &upper;
};
Limit LimitOf(QpProblem& qp, int j) {
  return j < qp.variables() ? Limit{qp.x_lower(j), qp.x_upper(j)} : Limit{qp.lower(j), qp.upper(j)};
}

/// What limit j is on.
double ValueOf(const QpProblem& qp, int j, const PerJoint& qdd) {
  return j < qp.variables() ? qdd(j) : qp.A.row(j).dot(qdd);
}

/// By how much x is outside of its limits.
template <class Vector>
Vector Slack(const Vector& lower, const Vector& x, const Vector& upper) {
  return (lower - x).cwiseMax(x - upper).cwiseMax(0);
}

/// What is made of the options has no more rows than these.
const ComplianceQp::Options& WithRoom(const ComplianceQp::Options& o) {
  Require(o.rows >= 0 && o.rows <= AccelerationRows::kMaxRows,
          "rows must be from 0 to " + Text(AccelerationRows::kMaxRows), o.rows);
  return o;
}

}  // namespace

ComplianceQpReport ComplianceQpReport::None(int joints, int rows) {
  const PerJoint none = PerJoint::Zero(joints);
  const AccelerationRows::Vector no_row = AccelerationRows::Vector::Zero(rows);
  return {.torque_multiplier = none,
          .bound_multiplier = none,
          .row_multiplier = no_row,
          .bound_slack = none,
          .row_slack = no_row};
}

ComplianceQp::ComplianceQp(const Options& o)
    : dynamics{this, "dynamics", WithRoom(o).model.joints()},
      external_torque{this, "external_torque", o.model.joints(),
                      JointTorque::Zero(o.model.joints())},
      torque_limit{this, "torque_limit", o.model.joints(), o.model.effort_limit()},
      objectives{this, "objectives", o.model.joints()},
      bounds{this, "bounds", o.model.joints()},
      rows{this, "rows", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      report{this, "report", o.model.joints(), ComplianceQpReport::None(o.model.size(), o.rows)},
      n_{o.model.size()},
      rows_{o.rows},
      d_{o.fallback_damping},
      solution_{this,
                "solution",
                {},
                {.qdd = JointAcceleration::Zero(o.model.joints()),
                 .torque = JointTorque::Zero(o.model.joints()),
                 .report = ComplianceQpReport::None(o.model.size(), o.rows),
                 .active = {}}},
      work_{this, "work",
            Workspace{.problem = QpProblem(o.model.size(), o.model.size() + o.rows),
                      .relaxed = QpProblem(o.model.size(), o.model.size()),
                      .solver = {},
                      .solution = {},
                      .none = {},
                      .feasible = {}}} {
  Require(o.fallback_damping >= 0 && std::isfinite(o.fallback_damping),
          "fallback_damping must be finite and >= 0", o.fallback_damping);
  Every(o.period)
      .Compute(solution_)
      .From(solution_, work_, dynamics, external_torque, torque_limit, objectives, bounds, rows)
      .As(&ComplianceQp::Solve);
  Compute(torque).From(solution_).As([](const Solution& s) { return s.torque; });
  Compute(acceleration).From(solution_).As([](const Solution& s) { return s.qdd; });
  Compute(report).From(solution_).As([](const Solution& s) { return s.report; });
}

bool ComplianceQp::Write(Workspace& w, const RobotDynamics& d, const JointTorque& limit,
                         const JointTorque& bias, const Joined<Objective>& terms,
                         const Joined<AccelerationBounds>& dampers,
                         const Joined<AccelerationRows>& rows) const {
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
  qp.A.topRows(n_) = d.M;
  qp.lower.head(n_) = -limit - bias;
  qp.upper.head(n_) = limit - bias;
  int at = n_;
  for (int k = 0; k < rows.size(); ++k) {
    const int m = static_cast<int>(rows[k].lower.size());
    if (at + m > n_ + rows_) return false;
    qp.A.middleRows(at, m) = rows[k].A;
    qp.lower.segment(at, m) = rows[k].lower;
    qp.upper.segment(at, m) = rows[k].upper;
    at += m;
  }
  return at == n_ + rows_;
}

void ComplianceQp::Solve(Solution& out, const Solution& last, Workspace& w, const RobotDynamics& d,
                         const JointTorque& tau_e, const JointTorque& limit,
                         const Joined<Objective>& terms, const Joined<AccelerationBounds>& dampers,
                         const Joined<AccelerationRows>& rows) const {
  using Outcome = ComplianceQpReport::Outcome;
  QpProblem& qp = w.problem;
  const JointTorque bias = d.coriolis + d.gravity - tau_e;
  const bool complete = Write(w, d, limit, bias, terms, dampers, rows);

  out.active = last.active;
  ComplianceQpReport& r = out.report;
  r.outcome = Outcome::Solved;
  r.relaxed_priority = 0;
  r.bound_slack.setZero();
  r.row_slack.setZero();
  r.status = complete ? pliant::Solve(qp, w.solver, out.active, w.solution) : QpStatus::InvalidData;
  r.iterations = complete ? w.solution.iterations : 0;
  QpStatus status = r.status;
  const bool contradict = status == QpStatus::Infeasible || status == QpStatus::IterationLimit;
  AccelerationRows::Vector lower, upper;  // as they were asked for
  PerJoint x_lower, x_upper;
  if (contradict) {
    lower = qp.lower.tail(rows_);
    upper = qp.upper.tail(rows_);
    x_lower = qp.x_lower;
    x_upper = qp.x_upper;
    r.outcome = Outcome::Relaxed;
    out.active.clear();
    w.feasible.resize(0);
    r.relaxed_priority = Relax(w, rows);
    status = pliant::Solve(qp, w.solver, out.active, w.solution);
    if (status != QpStatus::Solved && w.feasible.size() == n_) {
      // Lost to round-off: what satisfies the limits stands in for what serves the tasks best.
      status = QpStatus::Solved;
      out.active.clear();
      w.solution.x = w.feasible;
      w.solution.row_multipliers.setZero();
      w.solution.bound_multipliers.setZero();
    }
  }
  if (status != QpStatus::Solved) {
    r.outcome = Outcome::Fallback;
    r.torque_multiplier.setZero();
    r.bound_multiplier.setZero();
    r.row_multiplier.setZero();
    out.active.clear();
    out.torque = Fallback(d, limit);
    out.qdd = ForwardDynamics(d, out.torque, JointTorque(PerJoint::Zero(n_)));
    if (!out.qdd.allFinite()) out.qdd.setZero();
    return;
  }
  out.qdd = w.solution.x;
  r.torque_multiplier = w.solution.row_multipliers.head(n_);
  r.bound_multiplier = w.solution.bound_multipliers;
  r.row_multiplier = w.solution.row_multipliers.tail(rows_);
  if (contradict) {
    r.bound_slack = Slack<PerJoint>(x_lower, out.qdd, x_upper);
    r.row_slack =
        Slack<AccelerationRows::Vector>(lower, qp.A.bottomRows(rows_).lazyProduct(out.qdd), upper);
  }
  // The solver holds the rows to its round-off; the limit itself is hard.
  const JointTorque torque = d.M.lazyProduct(out.qdd) + bias;
  out.torque = Clamped(torque, limit);
}

int ComplianceQp::Relax(Workspace& w, const Joined<AccelerationRows>& rows) const {
  const int limits = n_ + rows_;
  Flags kept{};
  std::array<int, Flags{}.size()> priority{};
  std::fill_n(priority.begin(), n_, 1);
  auto* next = priority.begin() + n_;
  for (int k = 0; k < rows.size(); ++k)
    next = std::fill_n(next, rows[k].lower.size(), rows[k].priority);
  int first = 0;
  for (int done = 0; done < limits;) {
    // As many of the most important as there is room for their slacks.
    int most_important = std::numeric_limits<int>::max();
    for (int j = 0; j < limits; ++j)
      if (!kept[j]) most_important = std::min(most_important, priority[j]);
    Flags giving{};
    int count = 0;
    for (int j = 0; j < limits && count < kMaxQpVariables - n_; ++j)
      if (!kept[j] && priority[j] == most_important) giving[j] = true, ++count;
    if (Give(w, kept, giving, count) && first == 0) first = most_important;
    for (int j = 0; j < limits; ++j) kept[j] = kept[j] || giving[j];
    done += count;
  }
  return first;
}

bool ComplianceQp::Give(Workspace& w, const Flags& kept, const Flags& giving, int count) const {
  QpProblem &qp = w.problem, &relaxed = w.relaxed;
  const int limits = n_ + rows_;
  const int kept_rows =
      static_cast<int>(std::count(kept.begin() + n_, kept.begin() + limits, true));
  const int variables = n_ + count, all_rows = n_ + kept_rows + count;
  relaxed.H.setZero(variables, variables);
  relaxed.H.diagonal() << PerJoint::Ones(n_), QpProblem::Vector::Constant(count, 1e6);
  relaxed.g.setZero(variables);
  relaxed.x_lower.setConstant(variables, -kInfinity);
  relaxed.x_upper.setConstant(variables, kInfinity);
  relaxed.A.setZero(all_rows, variables);
  relaxed.lower.resize(all_rows);
  relaxed.upper.resize(all_rows);
  relaxed.A.topLeftCorner(n_, n_) = qp.A.topRows(n_);
  relaxed.lower.head(n_) = qp.lower.head(n_);
  relaxed.upper.head(n_) = qp.upper.head(n_);
  int row = n_, slack = n_;
  for (int j = 0; j < limits; ++j) {
    const Limit limit = LimitOf(qp, j);
    if (kept[j] && j < n_) {
      relaxed.x_lower(j) = limit.lower;
      relaxed.x_upper(j) = limit.upper;
    } else if (kept[j] || giving[j]) {
      if (j < n_)
        relaxed.A(row, j) = 1;
      else
        relaxed.A.row(row).head(n_) = qp.A.row(j);
      if (giving[j]) relaxed.A(row, slack++) = 1;
      const bool crossed = limit.lower > limit.upper;
      const double middle = limit.lower + (limit.upper - limit.lower) / 2;
      relaxed.lower(row) = crossed ? middle : limit.lower;
      relaxed.upper(row++) = crossed ? middle : limit.upper;
    }
  }
  w.none.clear();
  for (int pass = 0; pass < 2; ++pass) {
    if (pliant::Solve(relaxed, w.solver, w.none, w.solution) != QpStatus::Solved) return false;
    w.feasible = w.solution.x.head(n_);
    relaxed.g.head(n_) = -w.feasible;  // a second step of the proximal point method
  }
  const PerJoint qdd = w.feasible;
  bool moved = false;
  for (int j = 0; j < limits; ++j) {
    if (!giving[j]) continue;
    const Limit limit = LimitOf(qp, j);
    const double value = ValueOf(qp, j, qdd);
    const double round_off = 1e-9 * (1 + std::abs(value)), room = 10 * round_off;
    const bool below = value<limit.lower - round_off, above = value> limit.upper + round_off;
    if (below) limit.lower = value - room;
    if (above) limit.upper = value + room;
    moved = moved || below || above;
  }
  return moved;
}

JointTorque ComplianceQp::Fallback(const RobotDynamics& d, const JointTorque& limit) const {
  const JointTorque torque = d.gravity - d_ * d.v;
  return Clamped(torque, limit).unaryExpr([](double x) { return std::isfinite(x) ? x : 0; });
}

}  // namespace pliant
