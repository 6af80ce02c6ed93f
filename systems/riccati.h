#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pliant {

/// X with Aᵀ X + X A + Q = 0, unique if no two eigenvalues of A add up to 0. In Schur form, a
/// column at a time. Source: Bartels & Stewart, Comm. ACM 15 (1972) 820.
Eigen::MatrixXd SolveLyapunov(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q);

/// X with Aᵀ X A − X + Q = 0, unique if no two eigenvalues of A multiply to 1. The same way.
Eigen::MatrixXd SolveDiscreteLyapunov(const Eigen::MatrixXd& A, const Eigen::MatrixXd& Q);

/// The matrices of a quadratic cost ∫ (xᵀ Q x + uᵀ R u) dt, or Σ, over ẋ = A x + B u, or x⁺. Q is
/// symmetric and ≥ 0, R symmetric and > 0.
struct QuadraticCost {
  Eigen::MatrixXd Q, R;
};

/// The one X ≥ 0 for which A − B R⁻¹ Bᵀ X is stable:
///
///   Aᵀ X + X A − X B R⁻¹ Bᵀ X + Q = 0
///
/// By the sign of the Hamiltonian matrix, then Newton steps to working precision. Throws Error,
/// with the mode and the states it is in, if an unstable mode is moved by no input, if Q does not
/// see one that neither grows nor dies out, or if the residual shows that the numbers are too far
/// apart; `names` are those of the states. Sources: Byers, Linear Algebra Appl. 85 (1987) 267;
/// Kleinman, IEEE Trans. Automatic Control 13 (1968) 114.
Eigen::MatrixXd SolveRiccati(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                             const QuadraticCost& cost, const std::vector<std::string>& names = {});

/// The one X ≥ 0 for which A − B (R + Bᵀ X B)⁻¹ Bᵀ X A is stable, |λ| < 1:
///
///   Aᵀ X A − X − Aᵀ X B (R + Bᵀ X B)⁻¹ Bᵀ X A + Q = 0
///
/// By doubling, whose k-th iterate is that of the recursion after 2ᵏ steps, then Newton steps.
/// Errors as above, and Q has to see every mode that does not die out. Source: Chu, Fan, Lin &
/// Wang, Int. J. Control 77 (2004) 767.
Eigen::MatrixXd SolveDiscreteRiccati(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                     const QuadraticCost& cost,
                                     const std::vector<std::string>& names = {});

}  // namespace pliant
