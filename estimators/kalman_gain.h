#pragma once

#include <Eigen/Core>

#include "pliant/systems/linear_model.h"

namespace pliant {

/// What disturbs a sampled model x_{k+1} = A x_k + B u_k + w_k, y_k = C x_k + v_k: independent,
/// white, normal.
struct NoiseCovariance {
  Eigen::MatrixXd process;      ///< of w_k, symmetric and ≥ 0
  Eigen::MatrixXd measurement;  ///< of v_k, symmetric and > 0
};

/// The Kalman filter once its gain stands still.
struct SteadyKalman {
  Eigen::MatrixXd gain;       ///< L: x̂_k = x̂⁻_k + L (y_k − C x̂⁻_k)
  Eigen::MatrixXd predicted;  ///< covariance of x̂⁻_k − x_k
  Eigen::MatrixXd corrected;  ///< covariance of x̂_k − x_k
  Eigen::VectorXcd modes;     ///< by which its error dies out: eigenvalues of A (I − L C)
};

/// Solves the Riccati equation of the predicted covariance,
///
///   P = A P Aᵀ − A P Cᵀ (C P Cᵀ + V)⁻¹ C P Aᵀ + W,   L = P Cᵀ (C P Cᵀ + V)⁻¹
///
/// Throws Error, with the mode, if outputs do not tell one that does not die out, or noise does not
/// reach one: of that the filter would be sure some day, and blind. The model has no D.
/// Source: Anderson & Moore, Optimal Filtering, 1979, ch. 4.
SteadyKalman SteadyKalmanOf(const LinearModel& sampled, const NoiseCovariance& noise,
                            const Names& states = {});

/// Throws Error unless the noise fits the model, which must have no D.
void RequireNoise(const LinearModel& sampled, const NoiseCovariance& noise);

namespace internal {

/// Throws Error unless M is n × n, symmetric and ≥ 0, or > 0.
void RequireCovariance(const char* name, const Eigen::MatrixXd& M, Eigen::Index n,
                       bool strictly = false);

}  // namespace internal
}  // namespace pliant
