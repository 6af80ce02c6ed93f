#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pliant/systems/riccati.h"

namespace pliant {

/// The state feedback u = −K x of least quadratic cost.
struct Lqr {
  Eigen::MatrixXd K;
  Eigen::MatrixXd S;       ///< the cost from x on is xᵀ S x
  Eigen::VectorXcd modes;  ///< eigenvalues of A − B K
};

/// For ẋ = A x + B u and ∫ (xᵀ Q x + uᵀ R u) dt:
///
///   K = R⁻¹ Bᵀ S,   Aᵀ S + S A − S B R⁻¹ Bᵀ S + Q = 0
///
///   const Linearization l = Linearize(diagram, about, {.inputs = {arm.torque}});
///   const Lqr lqr = ContinuousLqr(l.A, l.B, {.Q = Q, .R = R}, l.states);
///
/// Throws Error as SolveRiccati does; `names` of the states are for that.
/// Source: Anderson & Moore, Optimal Control, 1990, ch. 3.
Lqr ContinuousLqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const QuadraticCost& cost,
                  const std::vector<std::string>& names = {});

/// For x⁺ = A x + B u and Σ (xᵀ Q x + uᵀ R u):
///
///   K = (R + Bᵀ S B)⁻¹ Bᵀ S A,   Aᵀ S A − S − Aᵀ S B K + Q = 0
Lqr DiscreteLqr(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const QuadraticCost& cost,
                const std::vector<std::string>& names = {});

}  // namespace pliant
