#include "pliant/controllers/external_acceleration.h"

#include <array>

namespace pliant {

namespace {

/// M⁻¹ τ for N joints, any number if N is 0, by M = L D Lᵀ. By hand, column by column: for seven
/// joints Eigen's factorization takes four times as long.
template <std::size_t N>
JointAcceleration Solved(const JointMatrix& M, const JointTorque& tau) {
  const std::size_t n = N > 0 ? N : static_cast<std::size_t>(M.rows());
  constexpr std::size_t kMost = N > 0 ? N : kMaxJoints;
  std::array<std::array<double, kMost>, kMost> L;  // by columns, times D
  std::array<double, kMost> inverse;               // of D
  PerJoint a = tau;
  double* const x = a.data();
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = j; i < n; ++i) L[j][i] = M.data()[j * n + i];
  for (std::size_t j = 0; j < n; ++j) {
    inverse[j] = 1 / L[j][j];
    for (std::size_t k = j + 1; k < n; ++k) {
      const double s = L[j][k] * inverse[j];
      for (std::size_t i = k; i < n; ++i) L[k][i] -= s * L[j][i];
      x[k] -= s * x[j];
    }
  }
  for (std::size_t j = n; j-- > 0;) {
    for (std::size_t i = j + 1; i < n; ++i) x[j] -= L[j][i] * x[i];
    x[j] *= inverse[j];
  }
  return a;
}

}  // namespace

ExternalAcceleration::ExternalAcceleration(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      external_torque{this, "external_torque", o.joints, JointTorque::Zero(o.joints)},
      acceleration{this, "acceleration", o.joints} {
  Compute(acceleration)
      .From(dynamics, external_torque)
      .As([](const RobotDynamics& d, const JointTorque& tau_e) -> JointAcceleration {
        return d.M.rows() == 7 ? Solved<7>(d.M, tau_e) : Solved<0>(d.M, tau_e);
      });
}

}  // namespace pliant
