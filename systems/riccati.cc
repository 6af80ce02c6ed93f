#include "pliant/systems/riccati.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

#include "pliant/systems/controllability.h"
#include "pliant/systems/number_vector.h"

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

constexpr double kSymmetry = 1e-9;  // of what is symmetric up to round-off
constexpr double kResidual = 1e-8;  // relative: a solution has lost half its digits
constexpr int kMostIterations = 100;
// A mode this near the edge of stability is on it: no solution would keep half its digits.
constexpr double kEdge = 1e-8;

MatrixXd Symmetric(const MatrixXd& X) { return (X + X.transpose()) / 2; }

void RequireSquare(const MatrixXd& A, const MatrixXd& Q) {
  Require(A.rows() >= 1, "A must have a row, the model a state");
  internal::RequireShape("A", A, A.rows(), A.rows(), "square");
  internal::RequireShape("Q", Q, A.rows(), A.rows(), "as A is");
}

void RequireSymmetric(const char* name, const MatrixXd& M) {
  const double off = (M - M.transpose()).cwiseAbs().maxCoeff();
  Require(off <= kSymmetry * M.cwiseAbs().maxCoeff(),
          std::string(name) + " must be symmetric; its largest difference from the transpose", off);
}

double LeastEigenvalue(const MatrixXd& M) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(Symmetric(M), Eigen::EigenvaluesOnly)
      .eigenvalues()(0);
}

void RequireProblem(const MatrixXd& A, const MatrixXd& B, const QuadraticCost& cost) {
  RequireSquare(A, cost.Q);
  Require(B.cols() >= 1, "B must have a column, the model an input");
  internal::RequireShape("B", B, A.rows(), B.cols(), "a row for each state");
  internal::RequireShape("R", cost.R, B.cols(), B.cols(), "as many as the columns of B");
  RequireSymmetric("Q", cost.Q);
  RequireSymmetric("R", cost.R);
  const double q = LeastEigenvalue(cost.Q), r = LeastEigenvalue(cost.R);
  Require(q >= -kSymmetry * cost.Q.norm(), "Q must be ≥ 0: its least eigenvalue", q);
  Require(r > 0, "R must be > 0: its least eigenvalue", r);
}

/// A mode on the imaginary axis that the cost does not see has no best feedback.
void RequireSeen(const MatrixXd& A, const MatrixXd& Q, const std::vector<std::string>& names) {
  const Controllability seen = ControllabilityOf(A.transpose(), Q);
  for (Index i = 0; i < seen.uncontrollable_modes.size(); ++i)
    if (std::abs(seen.uncontrollable_modes(i).real()) <= kEdge * A.norm())
      throw Error("Q does not see a mode that neither grows nor dies out: " + seen.text(i, names) +
                  "\nweigh it, or leave these states out");
}

/// `residual` of an equation whose terms have the size `terms`.
void RequireSolved(double residual, double terms) {
  if (!(residual <= kResidual * terms))
    throw Error(
        "the Riccati equation has no solution to working precision: its residual is " +
        Text(residual / terms) +
        " of its terms\nscale states and inputs to similar sizes, or see whether a mode is almost "
        "out of reach");
}

void RequireStable(const MatrixXd& closed, TimeDomain domain) {
  for (const std::complex<double> mode : VectorXcd(closed.eigenvalues()))
    Require(Instability(mode, domain) < 0,
            "the Riccati equation has no stabilizing solution to working precision: a mode of the "
            "closed loop must die out",
            "λ = " + Text(mode.real()) + " + " + Text(mode.imag()) + "i");
}

/// The sign of H: the limit of Newton's iteration S ← (S/c + c S⁻¹)/2, c = |det S|^(1/n).
MatrixXd Sign(const MatrixXd& H) {
  MatrixXd S = H;
  for (int i = 0; i < kMostIterations; ++i) {
    const Eigen::PartialPivLU<MatrixXd> lu(S);
    const double c = std::exp(lu.matrixLU().diagonal().cwiseAbs().array().log().sum() /
                              static_cast<double>(S.rows()));
    if (!(c > 0) || !std::isfinite(c)) break;
    const MatrixXd next = (S / c + c * lu.inverse()) / 2;
    const double change = (next - S).norm();
    S = next;
    if (change <= 1e-13 * S.norm()) break;
  }
  return S;
}

}  // namespace

MatrixXd SolveLyapunov(const MatrixXd& A, const MatrixXd& Q) {
  RequireSquare(A, Q);
  const Index n = A.rows();
  const Eigen::ComplexSchur<MatrixXd> schur(A);  // A = U T Uᴴ
  const MatrixXcd &U = schur.matrixU(), &T = schur.matrixT();
  const MatrixXcd F = U.adjoint() * Q * U;
  MatrixXcd Y(n, n);  // Tᴴ Y + Y T + F = 0, column by column
  for (Index k = 0; k < n; ++k) {
    VectorXcd f = -F.col(k);
    if (k > 0) f -= Y.leftCols(k) * T.col(k).head(k);
    MatrixXcd lower = T.adjoint();
    lower.diagonal().array() += T(k, k);
    const double least = lower.diagonal().cwiseAbs().minCoeff();
    Require(least > 1e-14 * T.norm(),
            "the Lyapunov equation has no unique solution: two eigenvalues of A add up to", least);
    Y.col(k) = lower.triangularView<Eigen::Lower>().solve(f);
  }
  return (U * Y * U.adjoint()).real();
}

MatrixXd SolveDiscreteLyapunov(const MatrixXd& A, const MatrixXd& Q) {
  RequireSquare(A, Q);
  const Index n = A.rows();
  const Eigen::ComplexSchur<MatrixXd> schur(A);
  const MatrixXcd &U = schur.matrixU(), &T = schur.matrixT();
  const MatrixXcd F = U.adjoint() * Q * U;
  MatrixXcd Y(n, n);  // Tᴴ Y T − Y + F = 0, column by column
  for (Index k = 0; k < n; ++k) {
    VectorXcd f = -F.col(k);
    if (k > 0) f -= T.adjoint() * (Y.leftCols(k) * T.col(k).head(k));
    MatrixXcd lower = T(k, k) * T.adjoint();
    lower.diagonal().array() -= 1;
    const double least = lower.diagonal().cwiseAbs().minCoeff();
    Require(least > 1e-14,
            "the Lyapunov equation has no unique solution: two eigenvalues of A multiply to 1 ±",
            least);
    Y.col(k) = lower.triangularView<Eigen::Lower>().solve(f);
  }
  return (U * Y * U.adjoint()).real();
}

MatrixXd SolveRiccati(const MatrixXd& A, const MatrixXd& B, const QuadraticCost& cost,
                      const std::vector<std::string>& names) {
  RequireProblem(A, B, cost);
  RequireStabilizable(A, B, TimeDomain::Continuous, names);
  RequireSeen(A, cost.Q, names);
  const Index n = A.rows();
  const MatrixXd Q = Symmetric(cost.Q);
  const Eigen::LLT<MatrixXd> R(Symmetric(cost.R));
  const MatrixXd G = Symmetric(B * R.solve(B.transpose()));

  MatrixXd H(2 * n, 2 * n);
  H << A, -G, -Q, -A.transpose();
  const MatrixXd W = Sign(H);
  MatrixXd left(2 * n, n), right(2 * n, n);
  left << W.topRightCorner(n, n), W.bottomRightCorner(n, n) + MatrixXd::Identity(n, n);
  right << W.topLeftCorner(n, n) + MatrixXd::Identity(n, n), W.bottomLeftCorner(n, n);
  MatrixXd X = Symmetric(left.colPivHouseholderQr().solve(-right));

  const auto residual = [&](const MatrixXd& x) -> MatrixXd {
    return A.transpose() * x + x * A - x * G * x + Q;
  };
  // Newton: (A − G X)ᵀ d + d (A − G X) + residual = 0, while that helps.
  for (int i = 0; i < 3 && X.allFinite(); ++i) {
    const MatrixXd closed = A - G * X;
    const MatrixXd r = Symmetric(residual(X));
    if (r.isZero(0) || VectorXcd(closed.eigenvalues()).real().maxCoeff() >= 0) break;
    const MatrixXd better = Symmetric(X + SolveLyapunov(closed, r));
    if (!(residual(better).norm() < r.norm())) break;
    X = better;
  }
  RequireSolved(residual(X).norm(), 2 * (A.transpose() * X).norm() + (X * G * X).norm() + Q.norm());
  RequireStable(A - G * X, TimeDomain::Continuous);
  return X;
}

MatrixXd SolveDiscreteRiccati(const MatrixXd& A, const MatrixXd& B, const QuadraticCost& cost,
                              const std::vector<std::string>& names) {
  RequireProblem(A, B, cost);
  RequireStabilizable(A, B, TimeDomain::Sampled, names);
  RequireDetectable(A, cost.Q, TimeDomain::Sampled, names);
  const Index n = A.rows();
  const MatrixXd R = Symmetric(cost.R), Q = Symmetric(cost.Q);
  MatrixXd a = A, g = Symmetric(B * R.llt().solve(B.transpose())), X = Q;
  for (int i = 0; i < kMostIterations && X.allFinite(); ++i) {
    const Eigen::PartialPivLU<MatrixXd> w(MatrixXd::Identity(n, n) + g * X);
    const MatrixXd wa = w.solve(a);
    const MatrixXd step = Symmetric(a.transpose() * X * wa);
    g = Symmetric(g + a * w.solve(g) * a.transpose());
    a = (a * wa).eval();
    X += step;
    if (step.norm() <= 1e-16 * X.norm()) break;
  }
  const auto closed = [&](const MatrixXd& x) -> MatrixXd {
    const MatrixXd Bx = B.transpose() * x;
    return A - B * MatrixXd(R + Bx * B).llt().solve(Bx * A);
  };
  const auto residual = [&](const MatrixXd& x) -> MatrixXd {
    return Symmetric(A.transpose() * x * closed(x)) - x + Q;
  };
  // Newton, since doubling loses digits where A grows (Hewer, IEEE Trans. Automatic Control 16
  // (1971) 382): Fᵀ d F − d + residual = 0, F = A − B K, while that helps.
  for (int i = 0; i < 3 && X.allFinite(); ++i) {
    const MatrixXd F = closed(X), r = residual(X);
    if (r.isZero(0) || VectorXcd(F.eigenvalues()).cwiseAbs().maxCoeff() >= 1) break;
    const MatrixXd better = Symmetric(X + SolveDiscreteLyapunov(F, r));
    if (!(residual(better).norm() < r.norm())) break;
    X = better;
  }
  RequireSolved(residual(X).norm(), (A.transpose() * X * A).norm() + X.norm() + Q.norm());
  RequireStable(closed(X), TimeDomain::Sampled);
  return X;
}

}  // namespace pliant
