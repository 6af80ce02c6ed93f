#include "pliant/controllers/external_acceleration.h"

#include <Eigen/Cholesky>

namespace pliant {

namespace {

/// M⁻¹ τ for N joints; faster where the compiler knows N.
template <int N>
JointAcceleration Solved(const JointMatrix& M, const JointTorque& tau) {
  constexpr int kMax = N == Eigen::Dynamic ? kMaxJoints : N;
  Eigen::Matrix<double, N, N, Eigen::ColMajor, kMax, kMax> L(M.rows(), M.cols());
  L = M;
  const Eigen::LLT<Eigen::Ref<decltype(L)>> llt(L);
  Eigen::Matrix<double, N, 1, Eigen::ColMajor, kMax, 1> a = tau;
  llt.solveInPlace(a);
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
        return d.M.rows() == 7 ? Solved<7>(d.M, tau_e) : Solved<Eigen::Dynamic>(d.M, tau_e);
      });
}

}  // namespace pliant
