#include "pliant/systems/controllability.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/systems/number_vector.h"

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

namespace {

/// A mode that round-off may put on either side counts as one that does not die out.
constexpr double kAtTheEdge = 1e-12;

void Check(const MatrixXd& A, const MatrixXd& B, double tolerance) {
  Require(A.rows() >= 1, "A must have a row, the model a state");
  internal::RequireShape("A", A, A.rows(), A.rows(), "square");
  internal::RequireShape("B", B, A.rows(), B.cols(), "a row for each state");
  Require(tolerance > 0 && tolerance < 1, "tolerance must be > 0 and < 1", tolerance);
}

std::string ModeText(std::complex<double> mode) {
  if (std::abs(mode.imag()) <= 1e-9 * std::abs(mode)) return Text(mode.real());
  return Text(mode.real()) + " ± " + Text(std::abs(mode.imag())) + "i";
}

void RequireDyingOut(const Controllability& reach, TimeDomain domain,
                     const std::vector<std::string>& names, const std::string& nothing,
                     const std::string& way_out) {
  for (Index i = 0; i < reach.uncontrollable_modes.size(); ++i)
    if (Instability(reach.uncontrollable_modes(i), domain) >= -kAtTheEdge)
      throw Error(nothing + " a mode that does not die out: " + reach.text(i, names) + "\n" +
                  way_out);
}

bool DiesOut(const Controllability& reach, TimeDomain domain) {
  return std::ranges::all_of(reach.uncontrollable_modes, [&](std::complex<double> mode) {
    return Instability(mode, domain) < -kAtTheEdge;
  });
}

}  // namespace

std::string Controllability::text(Index mode, const std::vector<std::string>& names) const {
  Require(names.empty() || static_cast<Index>(names.size()) == T.rows(),
          "names must be as many as the states, " + Text(T.rows()), names.size());
  const VectorXcd& at = left_eigenvectors.col(mode);
  const double largest = at.cwiseAbs().maxCoeff();
  std::string states;
  for (Index i = 0; i < at.size(); ++i)
    if (std::abs(at(i)) >= 0.1 * largest)
      states += (states.empty() ? "" : ", ") +
                (names.empty() ? "x" + Text(i + 1) : names[static_cast<std::size_t>(i)]);
  return "λ = " + ModeText(uncontrollable_modes(mode)) + ", in " + states;
}

Controllability ControllabilityOf(const MatrixXd& A, const MatrixXd& B, double tolerance) {
  Check(A, B, tolerance);
  const Index n = A.rows();
  Controllability reach{.size = 0,
                        .T = MatrixXd::Identity(n, n),
                        .uncontrollable_modes = {},
                        .left_eigenvectors = {}};
  MatrixXd a = A, coupling = B;  // Tᵀ A T, and what moves the states that are not reached yet
  double scale = B.norm();
  while (reach.size < n && coupling.cols() > 0 && scale > 0) {
    const Eigen::JacobiSVD<MatrixXd> svd(coupling, Eigen::ComputeFullU);
    const Index rank = (svd.singularValues().array() > tolerance * scale).count();
    if (rank == 0) break;
    const Index rest = n - reach.size;
    const MatrixXd turn = svd.matrixU();
    a.bottomRows(rest) = (turn.transpose() * a.bottomRows(rest)).eval();
    a.rightCols(rest) = (a.rightCols(rest) * turn).eval();
    reach.T.rightCols(rest) = (reach.T.rightCols(rest) * turn).eval();
    const Index from = reach.size;
    reach.size += rank;
    coupling = a.block(reach.size, from, n - reach.size, rank);
    scale = A.norm();
  }
  const Index rest = n - reach.size;
  if (rest == 0) return reach;
  // wᵀ A_u = λ wᵀ gives (T w)ᵀ A = λ (T w)ᵀ, as the rows of A_u stand alone.
  const Eigen::EigenSolver<MatrixXd> modes(a.bottomRightCorner(rest, rest).transpose());
  std::vector<Index> order(static_cast<std::size_t>(rest));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, std::greater<>(),
                    [&](Index i) { return modes.eigenvalues()(i).real(); });
  reach.uncontrollable_modes.resize(rest);
  reach.left_eigenvectors.resize(n, rest);
  for (Index i = 0; i < rest; ++i) {
    reach.uncontrollable_modes(i) = modes.eigenvalues()(order[static_cast<std::size_t>(i)]);
    reach.left_eigenvectors.col(i) = reach.T.rightCols(rest).cast<std::complex<double>>() *
                                     modes.eigenvectors().col(order[static_cast<std::size_t>(i)]);
  }
  return reach;
}

bool IsControllable(const MatrixXd& A, const MatrixXd& B, double tolerance) {
  return ControllabilityOf(A, B, tolerance).all();
}

bool IsObservable(const MatrixXd& A, const MatrixXd& C, double tolerance) {
  return IsControllable(A.transpose(), C.transpose(), tolerance);
}

bool IsStabilizable(const MatrixXd& A, const MatrixXd& B, TimeDomain domain, double tolerance) {
  return DiesOut(ControllabilityOf(A, B, tolerance), domain);
}

bool IsDetectable(const MatrixXd& A, const MatrixXd& C, TimeDomain domain, double tolerance) {
  return IsStabilizable(A.transpose(), C.transpose(), domain, tolerance);
}

double Instability(std::complex<double> mode, TimeDomain domain) {
  return domain == TimeDomain::Continuous ? mode.real() : std::abs(mode) - 1;
}

void RequireStabilizable(const MatrixXd& A, const MatrixXd& B, TimeDomain domain,
                         const std::vector<std::string>& names, double tolerance) {
  RequireDyingOut(ControllabilityOf(A, B, tolerance), domain, names, "no input moves",
                  "give an input that does, or leave these states out");
}

void RequireDetectable(const MatrixXd& A, const MatrixXd& C, TimeDomain domain,
                       const std::vector<std::string>& names, double tolerance) {
  RequireDyingOut(ControllabilityOf(A.transpose(), C.transpose(), tolerance), domain, names,
                  "nothing shows", "measure or weigh what does, or leave these states out");
}

}  // namespace pliant
