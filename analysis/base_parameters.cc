#include "pliant/analysis/base_parameters.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<Index> BaseParameters::alone() const {
  std::vector<Index> columns;
  for (std::size_t k = 0; k < kept.size(); ++k)
    if (beta.cols() == 0 || beta.row(static_cast<Index>(k)).cwiseAbs().maxCoeff() < 1e-6)
      columns.push_back(kept[k]);
  return columns;
}

VectorXd BaseParameters::Of(const VectorXd& x) const { return x(kept) + beta * x(dropped); }

std::string BaseParameters::text(std::size_t base, const std::vector<std::string>& names) const {
  std::string text = names[static_cast<std::size_t>(kept[base])];
  for (std::size_t d = 0; d < dropped.size(); ++d) {
    const double factor = beta(static_cast<Index>(base), static_cast<Index>(d));
    if (std::abs(factor) < 1e-6) continue;
    char number[32] = "";
    if (std::abs(std::abs(factor) - 1) > 1e-6)
      std::snprintf(number, sizeof number, "%.4g ", std::abs(factor));
    text += (factor < 0 ? " - " : " + ") + std::string(number) +
            names[static_cast<std::size_t>(dropped[d])];
  }
  return text;
}

BaseParameters FindBaseParameters(const MatrixXd& A, double tolerance) {
  BaseParameters base;
  const VectorXd lengths = A.colwise().norm();
  const double longest = lengths.size() > 0 ? lengths.maxCoeff() : 0;
  MatrixXd Q(A.rows(), std::min(A.rows(), A.cols()));  // of the columns kept
  Index rank = 0;
  for (Index k = 0; k < A.cols(); ++k) {
    if (!(lengths[k] > tolerance * longest)) {
      base.without.push_back(k);
      continue;
    }
    VectorXd left = A.col(k) / lengths[k];
    for (int twice = 0; twice < 2; ++twice)  // Gram–Schmidt, orthogonal to rounding
      left -= Q.leftCols(rank) * (Q.leftCols(rank).transpose() * left).eval();
    if (left.norm() < tolerance || rank == Q.cols()) {
      base.dropped.push_back(k);
      continue;
    }
    Q.col(rank++) = left.normalized();
    base.kept.push_back(k);
  }
  const MatrixXd kept = A(Eigen::all, base.kept);
  const VectorXd scale = lengths(base.kept);
  const MatrixXd unit = kept * scale.cwiseInverse().asDiagonal();
  base.beta = MatrixXd::Zero(rank, std::ssize(base.dropped));
  if (rank == 0) return base;
  if (!base.dropped.empty())
    base.beta =
        scale.cwiseInverse().asDiagonal() * unit.householderQr().solve(A(Eigen::all, base.dropped));
  base.beta = (base.beta.array().abs() < 1e-10).select(0.0, base.beta);  // round-off
  const VectorXd singular = Eigen::BDCSVD<MatrixXd>(unit).singularValues();
  base.condition = singular[0] / singular[rank - 1];
  return base;
}

}  // namespace pliant
