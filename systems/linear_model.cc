#include "pliant/systems/linear_model.h"

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXd;

MatrixXd LinearModel::feedthrough() const {
  return D.size() == 0 ? MatrixXd(MatrixXd::Zero(C.rows(), B.cols())) : D;
}

void RequireModel(const LinearModel& m) {
  Require(m.A.rows() >= 1, "A must have a row, the model a state");
  internal::RequireShape("A", m.A, m.A.rows(), m.A.rows(), "square");
  Require(m.B.cols() >= 1, "B must have a column, the model an input");
  Require(m.C.rows() >= 1, "C must have a row, the model an output");
  internal::RequireShape("B", m.B, m.A.rows(), m.B.cols(), "a row for each state");
  internal::RequireShape("C", m.C, m.C.rows(), m.A.rows(), "a column for each state");
  internal::RequireShape("D", m.feedthrough(), m.C.rows(), m.B.cols(), "as C and B are");
}

LinearModel TransferFunction(const std::vector<double>& b, const std::vector<double>& a) {
  Require(a.size() >= 2, "a must have at least two coefficients, for a state", a.size());
  Require(a[0] != 0, "a₀ must not be 0", a[0]);
  Require(!b.empty() && b.size() <= a.size(),
          "b must have from one coefficient to as many as a, " + Text(a.size()), b.size());
  const auto n = static_cast<Index>(a.size()) - 1;
  const auto at = [](const std::vector<double>& from, Index i) {
    return from[static_cast<std::size_t>(i)];
  };
  // b as long as a, and both divided by a₀.
  Eigen::VectorXd c = Eigen::VectorXd::Zero(n + 1), d(n + 1);
  const auto shift = static_cast<Index>(a.size() - b.size());
  for (Index i = 0; i < static_cast<Index>(b.size()); ++i) c(shift + i) = at(b, i) / a[0];
  for (Index i = 0; i <= n; ++i) d(i) = at(a, i) / a[0];
  LinearModel m{MatrixXd::Zero(n, n), MatrixXd::Zero(n, 1), MatrixXd(1, n), MatrixXd(1, 1)};
  m.A.bottomLeftCorner(n - 1, n - 1).setIdentity();
  m.A.row(0) = -d.tail(n).transpose();
  m.B(0, 0) = 1;
  m.C = (c.tail(n) - c(0) * d.tail(n)).transpose();
  m.D(0, 0) = c(0);
  RequireModel(m);
  return m;
}

LinearModel Sampled(const LinearModel& c, double h) {
  RequireModel(c);
  Require(h > 0 && std::isfinite(h), "h must be > 0 s", h);
  const Index n = c.A.rows(), m = c.B.cols();
  MatrixXd both = MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = h * c.A;
  both.topRightCorner(n, m) = h * c.B;
  const MatrixXd e = both.exp();
  return {e.topLeftCorner(n, n), e.topRightCorner(n, m), c.C, c.D};
}

MatrixXd SampledNoise(const MatrixXd& A, const MatrixXd& W, double h) {
  const Index n = A.rows();
  Require(n >= 1, "A must have a row");
  internal::RequireShape("A", A, n, n, "square");
  internal::RequireShape("W", W, n, n, "as A is");
  Require(h > 0 && std::isfinite(h), "h must be > 0 s", h);
  MatrixXd both = MatrixXd::Zero(2 * n, 2 * n);
  both.topLeftCorner(n, n) = -h * A;
  both.topRightCorner(n, n) = h * W;
  both.bottomRightCorner(n, n) = h * A.transpose();
  const MatrixXd e = both.exp();
  const MatrixXd noise = e.bottomRightCorner(n, n).transpose() * e.topRightCorner(n, n);
  return (noise + noise.transpose()) / 2;
}

namespace internal {

Names NamesOf(const Names& states, const LinearModel& model) {
  RequireModel(model);
  if (states.size() == 0) return Names::Numbered(model.A.rows());
  Require(states.size() == model.A.rows(),
          "states must be as many as the rows of A, " + Text(model.A.rows()), states.size());
  return states;
}

NumberVector InitialOf(const Eigen::VectorXd& initial, const LinearModel& model) {
  if (initial.size() == 0) return NumberVector(Eigen::VectorXd::Zero(model.A.rows()));
  Require(initial.size() == model.A.rows(),
          "initial must have a number for each state, " + Text(model.A.rows()), initial.size());
  Require(initial.allFinite(), "initial must be finite");
  return NumberVector(initial);
}

}  // namespace internal
}  // namespace pliant
