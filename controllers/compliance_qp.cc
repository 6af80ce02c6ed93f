#include "pliant/controllers/compliance_qp.h"

#include <cmath>
#include <limits>

namespace pliant {

ComplianceQp::ComplianceQp(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      external_torque{this, "external_torque", o.model.joints(), JointTorque::Zero(o.model.joints())},
      torque_limit{this, "torque_limit", o.model.joints(), o.model.effort_limit()},
      objectives{this, "objectives", o.model.joints()},
      bounds{this, "bounds", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      report{this, "report"},
      d_{o.fallback_damping},
      solution_{this,
                "solution",
                {},
                {JointAcceleration::Zero(o.model.joints()), JointTorque::Zero(o.model.joints()), {}, {}}},
      work_{this, "work", Workspace{QpProblem(o.model.size(), o.model.size()), {}, {}}} {
  Require(o.fallback_damping >= 0, "fallback_damping must be >= 0", o.fallback_damping);
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
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  QpProblem& qp = w.problem;
  qp.H.setZero();
  qp.g.setZero();
  for (int k = 0; k < terms.size(); ++k) {
    const Objective& t = terms[k];
    qp.H.noalias() += t.weight * t.A.transpose().lazyProduct(t.A);
    qp.g.noalias() -= t.weight * t.A.transpose().lazyProduct(t.b);
  }
  qp.x_lower.setConstant(-kInfinity);
  qp.x_upper.setConstant(kInfinity);
  for (int k = 0; k < dampers.size(); ++k) {
    qp.x_lower = qp.x_lower.cwiseMax(dampers[k].lower);
    qp.x_upper = qp.x_upper.cwiseMin(dampers[k].upper);
  }
  const JointTorque bias = d.coriolis + d.gravity - tau_e;
  qp.A = d.M;
  qp.lower = -limit - bias;
  qp.upper = limit - bias;

  out.active = last.active;
  ComplianceQpReport& r = out.report;
  r.status = pliant::Solve(qp, w.solver, out.active, w.solution);
  r.outcome = Outcome::Solved;
  r.iterations = w.solution.iterations;
  r.conflict = w.solution.conflict;
  QpStatus status = r.status;
  if (status == QpStatus::Infeasible || status == QpStatus::IterationLimit) {
    qp.x_lower.setConstant(-kInfinity);
    qp.x_upper.setConstant(kInfinity);
    out.active.clear();
    status = pliant::Solve(qp, w.solver, out.active, w.solution);
    r.outcome = Outcome::Relaxed;
  }
  if (status == QpStatus::Solved) {
    out.qdd = w.solution.x;
    out.torque = d.M.lazyProduct(out.qdd) + bias;
    // The solver holds the rows to its round-off; the limit itself is hard.
    out.torque = out.torque.cwiseMax(-limit).cwiseMin(limit).eval();
    return;
  }
  r.outcome = Outcome::Fallback;
  out.active.clear();
  out.qdd.setZero();
  out.torque = (d.gravity - d_ * d.v).cwiseMax(-limit).cwiseMin(limit);
  out.torque = out.torque.unaryExpr([](double x) { return std::isfinite(x) ? x : 0; }).eval();
}

}  // namespace pliant
