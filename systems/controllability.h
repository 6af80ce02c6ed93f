#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

namespace pliant {

/// Whether a linear model ẋ = A x + B u is one of continuous time, or x⁺ = A x + B u of a sampled
/// one: where its modes are stable, Re λ < 0 or |λ| < 1.
enum class TimeDomain { Continuous, Sampled };

/// What inputs reach of the states. In the orthonormal basis T, of which the first `size` columns
/// span the states that can be reached,
///
///   Tᵀ A T = [A_r  A_×]    Tᵀ B = [B_r]
///            [ 0   A_u]           [ 0 ]
///
/// The eigenvalues of A_u are the modes that no input moves.
struct Controllability {
  Eigen::Index size = 0;
  Eigen::MatrixXd T;
  Eigen::VectorXcd uncontrollable_modes;  ///< eigenvalues of A_u, the slowest to die out first
  Eigen::MatrixXcd left_eigenvectors;     ///< of A, a column for each of these modes

  bool all() const { return size == T.rows(); }

  /// "λ = 0.5, in x2, x3" of an uncontrollable mode, with the states in which it is at least a
  /// tenth of what it is in the largest. `names` are those of the states; none: x1, x2, …
  std::string text(Eigen::Index mode, const std::vector<std::string>& names = {}) const;
};

/// By a staircase of singular value decompositions, which takes no power of A. A singular value
/// below `tolerance` times |B|, or later |A|, is taken for zero: the default is some hundred times
/// what round-off leaves in matrices that are exact, and 1e-6 suits those that Linearize took by
/// differences. Scale states that differ by many orders of magnitude.
/// Source: Paige, IEEE Trans. Automatic Control 26 (1981) 130.
Controllability ControllabilityOf(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
                                  double tolerance = 1e-12);

/// Inputs reach every state.
bool IsControllable(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double tolerance = 1e-12);
/// Outputs y = C x tell every state.
bool IsObservable(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C, double tolerance = 1e-12);

/// What no input moves dies out: every uncontrollable mode is stable.
bool IsStabilizable(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, TimeDomain domain,
                    double tolerance = 1e-12);
/// What no output tells dies out.
bool IsDetectable(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C, TimeDomain domain,
                  double tolerance = 1e-12);

/// How far a mode is from stability: Re λ, or |λ| − 1. Stable below 0.
double Instability(std::complex<double> mode, TimeDomain domain);

/// Throws Error with the mode, and the states it shows in, unless all that `input` cannot move dies
/// out: "no input moves a mode that does not die out: λ = 0.5, in x2, x3". `names` are those of the
/// states; none: x1, x2, …
void RequireStabilizable(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, TimeDomain domain,
                         const std::vector<std::string>& names = {}, double tolerance = 1e-12);
/// The same of what outputs do not tell.
void RequireDetectable(const Eigen::MatrixXd& A, const Eigen::MatrixXd& C, TimeDomain domain,
                       const std::vector<std::string>& names = {}, double tolerance = 1e-12);

}  // namespace pliant
