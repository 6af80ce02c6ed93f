#include "pliant/estimators/kalman_filter.h"

namespace pliant::internal {

using Eigen::Index;
using Eigen::MatrixXd;

KalmanStep::KalmanStep(const LinearModel& m, const NoiseCovariance& noise) {
  RequireNoise(m, noise);
  A_ = m.A;
  C_ = m.C;
  W_ = noise.process;
  V_ = noise.measurement;
  const Index n = A_.rows(), p = C_.rows();
  PCt_.setZero(n, p);
  left_.setZero(n, n);
  product_.setZero(n, n);
  gain_T_.setZero(p, n);
  S_ = Eigen::LLT<MatrixXd>(V_);
}

void KalmanStep::Correct(const MatrixXd& P, MatrixXd& gain, MatrixXd& corrected,
                         MatrixXd& innovation) {
  PCt_.noalias() = P.lazyProduct(C_.transpose());
  innovation = V_;
  innovation.noalias() += C_.lazyProduct(PCt_);
  S_.compute(innovation);
  gain_T_ = PCt_.transpose();
  S_.solveInPlace(gain_T_);
  gain = gain_T_.transpose();

  left_.setIdentity();
  left_.noalias() -= gain.lazyProduct(C_);
  product_.noalias() = left_.lazyProduct(P);
  corrected.noalias() = product_.lazyProduct(left_.transpose());
  PCt_.noalias() = gain.lazyProduct(V_);
  corrected.noalias() += PCt_.lazyProduct(gain.transpose());
  product_ = corrected.transpose();
  corrected = (corrected + product_) / 2;
}

void KalmanStep::Predict(const MatrixXd& P, MatrixXd& predicted) {
  product_.noalias() = A_.lazyProduct(P);
  predicted = W_;
  predicted.noalias() += product_.lazyProduct(A_.transpose());
}

}  // namespace pliant::internal
