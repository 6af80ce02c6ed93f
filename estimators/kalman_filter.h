#pragma once

#include <Eigen/Cholesky>

#include "pliant/estimators/kalman_gain.h"

namespace pliant {

namespace internal {

/// The covariances of a Kalman filter, and room to compute them in.
class KalmanStep {
 public:
  KalmanStep() = default;
  KalmanStep(const LinearModel& model, const NoiseCovariance& noise);

  /// The gain of a predicted covariance, and in Joseph's form what the correction leaves of it.
  void Correct(const Eigen::MatrixXd& predicted, Eigen::MatrixXd& gain, Eigen::MatrixXd& corrected,
               Eigen::MatrixXd& innovation);
  /// A P Aᵀ + W.
  void Predict(const Eigen::MatrixXd& corrected, Eigen::MatrixXd& predicted);

 private:
  Eigen::MatrixXd A_, C_, W_, V_;
  Eigen::MatrixXd PCt_, left_, product_, gain_T_;
  Eigen::LLT<Eigen::MatrixXd> S_;
};

}  // namespace internal

/// The Kalman filter of a sampled linear model, with the covariance of its own error:
///
///   S_k = C P⁻_k Cᵀ + V,   L_k = P⁻_k Cᵀ S_k⁻¹,   ν_k = y_k − C x̂⁻_k
///   x̂_k = x̂⁻_k + L_k ν_k
///   P_k = (I − L_k C) P⁻_k (I − L_k C)ᵀ + L_k V L_kᵀ
///   x̂⁻_{k+1} = A x̂_k + B u_k,   P⁻_{k+1} = A P_k Aᵀ + W,   x̂⁻_0 = initial, P⁻_0 = covariance
///
/// The form of P_k, Joseph's, stays symmetric and ≥ 0 in round-off. A tick at which `valid` is
/// false has no measurement: L_k = 0. At tick k the estimate knows y_k, and u up to k − 1. If the
/// model is right, ν_k is white with covariance S_k. NaN of a valid measurement stays.
/// Source: Anderson & Moore, Optimal Filtering, 1979, ch. 3; Bucy & Joseph, Filtering for
/// Stochastic Processes, 1968.
template <class U = NumberVector, class Y = NumberVector>
class KalmanFilter final : public Block {
 public:
  using SpaceU = typename internal::SpaceOf<U>::type;
  using SpaceY = typename internal::SpaceOf<Y>::type;
  struct Options {
    SpaceU input = {};
    SpaceY output = {};
    Names states = {};  ///< none: x1, x2, …
    LinearModel model;  ///< sampled every period, without D
    NoiseCovariance noise;
    Eigen::VectorXd initial = {};  ///< x̂⁻_0; none: zero
    Eigen::MatrixXd covariance;    ///< P⁻_0, symmetric and ≥ 0
    Duration period;
  };

  explicit KalmanFilter(const Options& o);

  Input<U> u;  ///< what moves the plant from this tick on
  Input<Y> y;
  Input<bool> valid;                              ///< whether y was measured; true if not connected
  Output<NumberVector> x;                         ///< x̂_k
  Output<Eigen::MatrixXd> covariance;             ///< P_k
  Output<NumberVector> innovation;                ///< ν_k; zero without a measurement
  Output<Eigen::MatrixXd> innovation_covariance;  ///< S_k

 private:
  using Matrix = Eigen::MatrixXd;

  /// Of one tick, computed once.
  struct Solution {
    Matrix gain, corrected, innovation;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("gain", gain, "");
      f("corrected", corrected, "");
      f("innovation", innovation, "");
    }
  };

  void Solve(Solution& s, internal::KalmanStep& room, const Matrix& predicted,
             bool is_valid) const {
    room.Correct(predicted, s.gain, s.corrected, s.innovation);
    if (is_valid) return;
    s.gain.setZero();
    s.corrected = predicted;
  }
  NumberVector Innovation(const Y& measured, const NumberVector& predicted, bool is_valid) const {
    NumberVector nu = internal::Times<NumberVector>(C_, predicted);
    if (is_valid)
      nu = internal::AsColumn(measured) - nu;
    else
      nu.setZero();
    return nu;
  }
  NumberVector Correct(const NumberVector& predicted, const Solution& s,
                       const NumberVector& nu) const {
    return predicted + internal::Times<NumberVector>(s.gain, nu);
  }
  NumberVector Predict(const NumberVector& now, const U& in) const {
    return internal::Times<NumberVector>(A_, now) + internal::Times<NumberVector>(B_, in);
  }

  Discrete<NumberVector> predicted_;
  Discrete<Matrix> predicted_covariance_;
  Output<Solution> solution_;
  Scratch<internal::KalmanStep> room_;
  const Matrix A_, B_, C_;
};

template <class U, class Y>
KalmanFilter<U, Y>::KalmanFilter(const Options& o)
    : u{this, "u", o.input},
      y{this, "y", o.output},
      valid{this, "valid", {}, true},
      x{this, "x", internal::NamesOf(o.states, o.model), internal::InitialOf(o.initial, o.model)},
      covariance{this, "covariance", {}, o.covariance},
      innovation{this, "innovation", Names::Numbered(o.model.C.rows(), "y")},
      innovation_covariance{this, "innovation_covariance", {}, o.noise.measurement},
      predicted_{this, "predicted", internal::NamesOf(o.states, o.model),
                 internal::InitialOf(o.initial, o.model)},
      predicted_covariance_{this, "predicted_covariance", {}, o.covariance},
      solution_{this,
                "solution",
                {},
                Solution{Matrix::Zero(o.model.A.rows(), o.model.C.rows()), o.covariance,
                         o.noise.measurement}},
      room_{this, "room", internal::KalmanStep(o.model, o.noise)},
      A_{o.model.A},
      B_{o.model.B},
      C_{o.model.C} {
  internal::RequireEnds<U, Y>(o.model, o.input, o.output);
  internal::RequireCovariance("covariance", o.covariance, A_.rows());
  const PeriodicEvent tick = Every(o.period);
  tick.Compute(solution_).From(room_, predicted_covariance_, valid).As(&KalmanFilter::Solve);
  tick.Compute(innovation).From(y, predicted_, valid).As(&KalmanFilter::Innovation);
  tick.Compute(x).From(predicted_, solution_, innovation).As(&KalmanFilter::Correct);
  tick.Compute(covariance).From(solution_).As([](Matrix& P, const Solution& s) {
    P = s.corrected;
  });
  tick.Compute(innovation_covariance).From(solution_).As([](Matrix& S, const Solution& s) {
    S = s.innovation;
  });
  tick.Update(predicted_).From(x, u).As(&KalmanFilter::Predict);
  tick.Update(predicted_covariance_)
      .From(room_, solution_)
      .As([](Matrix& P, internal::KalmanStep& room, const Solution& s) {
        room.Predict(s.corrected, P);
      });
}

}  // namespace pliant
