#include "pliant/estimators/contact_force_estimate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pliant {

ContactForceEstimate::ContactForceEstimate(const Options& o)
    : places{this, "places"},
      dynamics{this, "dynamics", o.model.joints()},
      residual{this, "residual", o.model.joints()},
      touched{this, "touched", {}, true},
      contacts{this, "contacts"},
      observability{this, "observability"},
      explained{this, "explained", o.model.joints()},
      model_{o.model},
      sigma_{o.smallest_lever},
      solution_{this, "solution"} {
  RequireInRange("", "smallest_lever", o.smallest_lever, "m", kPositive);
  Every(o.period)
      .Compute(solution_)
      .From(places, dynamics, residual, touched)
      .As(&ContactForceEstimate::Solve);
  Compute(contacts).From(solution_).As([](const Solution& s) { return s.contacts; });
  Compute(observability).From(solution_).As([](const Solution& s) { return s.observability; });
  Compute(explained).From(contacts, dynamics).As(&ContactForceEstimate::Explain);
}

ContactForceEstimate::Solution ContactForceEstimate::Solve(const Contacts& at,
                                                           const RobotDynamics& d,
                                                           const JointTorque& r,
                                                           const bool& felt) const {
  constexpr int kRows = ContactObservability::kMaxRows;
  Solution out;
  if (!felt) return out;
  Eigen::Matrix<double, kRows, Eigen::Dynamic, Eigen::ColMajor, kRows, kMaxJoints> J;
  J.setZero(kRows, model_.size());
  // Rows without a contact get an eigenvalue of their own, which none of a square has.
  ContactObservability::Vector none = ContactObservability::Vector::Constant(-1);
  for (int i = 0; i < kMaxContacts; ++i) {
    const ContactForce& place = at.at[static_cast<std::size_t>(i)];
    if (!IsLink(model_, place.link)) continue;
    J.middleRows<3>(3 * i) = PointDynamics(model_, d, place.link, place.point).J.bottomRows<3>();
    none.segment<3>(3 * i).setZero();
    out.contacts.at[static_cast<std::size_t>(i)] = {
        place.link, place.point, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    out.observability.rows += 3;
  }
  if (out.observability.rows == 0) return out;

  // J Jᵀ = U diag(σ²) Uᵀ
  ContactObservability::Matrix squares = J.lazyProduct(J.transpose());
  squares.diagonal() += none;
  const Eigen::SelfAdjointEigenSolver<ContactObservability::Matrix> eigen(squares);
  const ContactObservability::Vector torque = J.lazyProduct(r);
  ContactObservability::Vector F = ContactObservability::Vector::Zero();
  for (int j = 0; j < out.observability.rows; ++j) {
    const int k = kRows - 1 - j;  // they rise
    const double square = std::max(eigen.eigenvalues()(k), 0.0);
    const ContactObservability::Vector u = eigen.eigenvectors().col(k);
    out.observability.singular_values(j) = std::sqrt(square);
    out.observability.directions.col(j) = u;
    out.observability.smallest = std::sqrt(square);
    if (square >= sigma_ * sigma_) ++out.observability.rank;
    // uᵀ J r = σ vᵀ r
    const double factor = 1 / std::max(square, sigma_ * sigma_);
    F += factor * u.dot(torque) * u;
  }
  for (int i = 0; i < kMaxContacts; ++i)
    out.contacts.at[static_cast<std::size_t>(i)].force = F.segment<3>(3 * i);
  return out;
}

JointTorque ContactForceEstimate::Explain(const Contacts& found, const RobotDynamics& d) const {
  return ExternalTorque(model_, d, found.at);
}

}  // namespace pliant
