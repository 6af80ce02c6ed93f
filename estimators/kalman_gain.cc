#include "pliant/estimators/kalman_gain.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "pliant/systems/controllability.h"
#include "pliant/systems/riccati.h"

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr double kSymmetry = 1e-9;    // of what is symmetric up to round-off
constexpr double kAtTheEdge = 1e-12;  // of stability, as far as round-off tells

}  // namespace

namespace internal {

void RequireCovariance(const char* name, const MatrixXd& M, Index n, bool strictly) {
  RequireShape(name, M, n, n, "a row and a column for each number");
  const double size = M.cwiseAbs().maxCoeff();
  const double off = (M - M.transpose()).cwiseAbs().maxCoeff();
  Require(off <= kSymmetry * size,
          std::string(name) + " must be symmetric; its largest difference from the transpose", off);
  const double least =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(M, Eigen::EigenvaluesOnly).eigenvalues()(0);
  Require(
      strictly ? least > 0 : least >= -kSymmetry * size,
      std::string(name) + (strictly ? " must be > 0" : " must be ≥ 0") + ": its least eigenvalue",
      least);
}

}  // namespace internal

void RequireNoise(const LinearModel& m, const NoiseCovariance& noise) {
  RequireModel(m);
  Require(m.feedthrough().isZero(0), "D must be zero: a filter measures the states");
  internal::RequireCovariance("process", noise.process, m.A.rows());
  internal::RequireCovariance("measurement", noise.measurement, m.C.rows(), true);
}

SteadyKalman SteadyKalmanOf(const LinearModel& m, const NoiseCovariance& noise,
                            const Names& states) {
  RequireNoise(m, noise);
  std::vector<std::string> names;
  for (int i = 0; i < states.size(); ++i) names.push_back(states[i]);
  RequireDetectable(m.A, m.C, TimeDomain::Sampled, names);
  const Controllability moved = ControllabilityOf(m.A, noise.process);
  for (Index i = 0; i < moved.uncontrollable_modes.size(); ++i)
    if (Instability(moved.uncontrollable_modes(i), TimeDomain::Sampled) >= -kAtTheEdge)
      throw Error("no noise reaches a mode that does not die out: " + moved.text(i, names) +
                  "\ngive it process noise, or leave these states out");
  const Index n = m.A.rows();
  const MatrixXd P = SolveDiscreteRiccati(m.A.transpose(), m.C.transpose(),
                                          {.Q = noise.process, .R = noise.measurement}, names);
  const MatrixXd S = m.C * P * m.C.transpose() + noise.measurement;
  const MatrixXd L = S.llt().solve(m.C * P).transpose();
  const MatrixXd left = MatrixXd::Identity(n, n) - L * m.C;
  return {L, P, left * P * left.transpose() + L * noise.measurement * L.transpose(),
          (m.A * left).eigenvalues()};
}

}  // namespace pliant
