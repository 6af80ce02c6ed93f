#include "pliant/controllers/null_space.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pliant {

NullSpaceProjector::NullSpaceProjector(const Options& o)
    : null_space{this, "null_space", o.joints, NullSpace(o.joints.size())}, s0_{o.damped_below} {
  RequireInRange("", "damped_below", o.damped_below, "", kPositive);
  Compute(null_space).From(frame).As(&NullSpaceProjector::Project);
  Compute(least_singular).From(null_space).As([](const NullSpace& of) {
    return of.least_singular;
  });
}

void NullSpaceProjector::Project(NullSpace& out, const FrameDynamics& now) const {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const Matrix6 K = now.J.lazyProduct(now.J.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(K);  // σ², u
  const auto gain = [this](double k) {                    // 1/(σ² + λ²)
    const double squared = std::max(k, 0.0);
    return 1 / (squared + 0.25 * std::max(s0_ * s0_ - squared, 0.0));
  };
  const Vector6 gains = eigen.eigenvalues().unaryExpr(gain);
  const Matrix6 U = eigen.eigenvectors();
  const Matrix6 inverse = U * gains.asDiagonal() * U.transpose();
  const Matrix6 root = U * gains.cwiseSqrt().asDiagonal();
  out.inverse = now.J.transpose().lazyProduct(inverse);
  const JacobianInverse W = now.J.transpose().lazyProduct(root);
  out.projector = -W.lazyProduct(W.transpose());
  out.projector.diagonal().array() += 1;
  out.least_singular = std::sqrt(std::max(eigen.eigenvalues()(0), 0.0));
}

}  // namespace pliant
