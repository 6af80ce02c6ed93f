#pragma once

#include <string_view>
#include <vector>

#include "pliant/systems/number_vector.h"

namespace pliant {

/// ẋ = A x + B u, or of a sampled one x⁺ = A x + B u;   y = C x + D u.
struct LinearModel {
  Eigen::MatrixXd A, B, C;
  Eigen::MatrixXd D = {};  ///< left out: zero

  /// D, zero where it was left out.
  Eigen::MatrixXd feedthrough() const;
};

/// Throws Error unless A is square and B, C, D fit it and are finite. A model has at least one
/// state, input and output.
void RequireModel(const LinearModel& model);

/// y = (b₀ sⁿ + … + b_n)/(a₀ sⁿ + … + a_n) u, in controllable canonical form, or the same in z of a
/// sampled model. b is no longer than a, and a₀ ≠ 0.
LinearModel TransferFunction(const std::vector<double>& b, const std::vector<double>& a);

/// The same system sampled every h [s], its input held between the samples:
///
///   A_h = e^{A h},   B_h = ∫₀ʰ e^{A s} ds B,   C and D as they are
///
/// By one matrix exponential. Source: Van Loan, IEEE Trans. Automatic Control 23 (1978) 395.
LinearModel Sampled(const LinearModel& continuous, double h);

/// The covariance of the noise that white noise w of spectral density W [unit²·s] on the states,
/// ẋ = A x + w, has made after h [s]: ∫₀ʰ e^{A s} W e^{Aᵀ s} ds. Source: as above.
Eigen::MatrixXd SampledNoise(const Eigen::MatrixXd& A, const Eigen::MatrixXd& W, double h);

namespace internal {

/// Checks the model first, since blocks make their values of it.
Names NamesOf(const Names& states, const LinearModel& model);
NumberVector InitialOf(const Eigen::VectorXd& initial, const LinearModel& model);

/// Throws Error unless B has a column for each number of U, and C a row for each of Y.
template <class U, class Y>
void RequireEnds(const LinearModel& model, const typename SpaceOf<U>::type& input,
                 const typename SpaceOf<Y>::type& output) {
  RequireShape("B", model.B, model.A.rows(), NumbersOf<U>(input), "as the states and u are");
  RequireShape("C", model.C, NumbersOf<Y>(output), model.A.rows(), "as y and the states are");
}

}  // namespace internal
}  // namespace pliant
