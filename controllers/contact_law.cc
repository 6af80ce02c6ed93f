#include "pliant/controllers/contact_law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using Outcome = ContactLawReport::Outcome;
using Rows = Eigen::Matrix<double, ContactLaw::kMaxRows, 1>;
using Square = Eigen::Matrix<double, ContactLaw::kMaxRows, ContactLaw::kMaxRows>;
using Stack = Eigen::Matrix<double, ContactLaw::kMaxRows, Eigen::Dynamic, Eigen::ColMajor,
                            ContactLaw::kMaxRows, kMaxJoints>;

}  // namespace

ContactLaw::ContactLaw(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      contacts{this, "contacts"},
      objectives{this, "objectives", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      acceleration{this, "acceleration", o.model.joints()},
      report{this, "report"},
      o_{o},
      limit_{o.model.effort_limit()},
      solution_{this,
                "solution",
                {},
                Solution{JointTorque::Zero(o.model.joints()),
                         JointAcceleration::Zero(o.model.joints()),
                         {},
                         o.posture}} {
  RequireInRange("", o.settings);
  RequireEachInRange("posture", o.posture, "rad", kAnyNumber, o.model.joints());
  RequireInRange("", "fallback_damping", o.fallback_damping, "N·m·s/rad", kNotNegative);
  Every(o.period)
      .Compute(solution_)
      .From(solution_, dynamics, contacts, objectives)
      .As(&ContactLaw::Solve);
  Compute(torque).From(solution_).As([](const Solution& s) { return s.torque; });
  Compute(acceleration).From(solution_).As([](const Solution& s) { return s.qdd; });
  Compute(report).From(solution_).As([](const Solution& s) { return s.report; });
}

ContactLaw::Solution ContactLaw::Solve(const Solution& last, const RobotDynamics& d,
                                       const Contacts& at, const Joined<Objective>& wishes) const {
  Solution now = last;
  now.report = {};
  now.qdd = Serve(now.report, d, wishes);
  if (now.report.outcome == Outcome::Posture) {
    if (last.report.rows > 0 && d.q.allFinite()) now.posture = d.q;
    now.qdd = Hold(d, now.posture);
  }
  now.torque = InverseDynamics(d, now.qdd) - ExternalTorque(o_.model, d, at.at);
  if (now.report.outcome == Outcome::Fallback || !now.torque.allFinite()) {
    now.report.outcome = Outcome::Fallback;
    now.qdd.setZero();
    now.torque = d.gravity - o_.fallback_damping * d.v;
  }
  for (int i = 0; i < now.torque.size(); ++i)
    if (std::abs(now.torque(i)) > limit_(i)) {
      now.torque(i) = std::copysign(limit_(i), now.torque(i));
      now.report.saturated |= 1U << i;
    }
  return now;
}

/// q̈₀ + M⁻¹ Aᵀ (A M⁻¹ Aᵀ)⁻¹ (b − A q̈₀)
JointAcceleration ContactLaw::Serve(ContactLawReport& told, const RobotDynamics& d,
                                    const Joined<Objective>& wishes) const {
  const JointAcceleration qdd_0 = -o_.settings.null_damping * d.v;
  Stack A;
  A.setZero(kMaxRows, d.v.size());
  Rows b = Rows::Zero();
  for (int i = 0; i < wishes.size(); ++i) {
    const Objective& wish = wishes[i];
    if (!(wish.weight > 0) || wish.A.isZero(0)) continue;
    const int rows = static_cast<int>(wish.A.rows());
    told.outcome = std::max(told.outcome, Outcome::Contact);
    if (told.rows + rows > kMaxRows) {
      told.outcome = Outcome::LeftOut;
      continue;
    }
    A.middleRows(told.rows, rows) = wish.A;
    b.segment(told.rows, rows) = wish.b;
    told.rows += rows;
  }
  if (told.rows == 0) return qdd_0;

  const Eigen::LLT<JointMatrix> M(d.M);
  if (M.info() != Eigen::Success) {
    told.outcome = Outcome::Fallback;
    return qdd_0;
  }
  Eigen::Matrix<double, Eigen::Dynamic, kMaxRows, Eigen::ColMajor, kMaxJoints, kMaxRows> root =
      A.transpose();
  M.matrixL().solveInPlace(root);
  // A M⁻¹ Aᵀ = rootᵀ root. Rows that are not used have an eigenvalue of their own, below all
  // others.
  Square K = root.transpose().lazyProduct(root);
  K.diagonal().tail(kMaxRows - told.rows).setConstant(-1);
  const Eigen::SelfAdjointEigenSolver<Square> eigen(K);
  told.smallest_mobility = std::max(0.0, eigen.eigenvalues()(kMaxRows - told.rows));
  const double k0 = 1 / o_.settings.inertia_limit;
  const Rows missing = b - A.lazyProduct(qdd_0);
  const Rows in_axes = eigen.eigenvectors().transpose() * missing;
  const Rows inverses = eigen.eigenvalues().unaryExpr(
      [k0](double k) { return k >= k0 ? 1 / k : std::max(k, 0.0) / (k0 * k0); });
  const Rows force = eigen.eigenvectors() * inverses.cwiseProduct(in_axes);
  PerJoint served = root.lazyProduct(force);
  M.matrixU().solveInPlace(served);
  return qdd_0 + served;
}

JointAcceleration ContactLaw::Hold(const RobotDynamics& d, const JointPosition& q_h) const {
  JointAcceleration qdd = -o_.settings.posture_damping * d.v;
  for (int i = 0; i < qdd.size(); ++i) {
    double error = q_h(i) - d.q(i);
    if (o_.model.joint(i).type == Joint::Type::Continuous)
      error = std::remainder(error, 2 * std::numbers::pi);
    qdd(i) += o_.settings.posture_stiffness * error;
  }
  return qdd;
}

}  // namespace pliant
