#include "pliant/analysis/row_triangle.h"

#include <Eigen/QR>

namespace pliant {

using Eigen::Index;
using Eigen::MatrixXd;

RowTriangle::RowTriangle(Index columns)
    : triangle_{MatrixXd::Zero(columns + 1, columns + 1)},
      block_{MatrixXd::Zero(4 * (columns + 1), columns + 1)} {}

void RowTriangle::Add(const Eigen::Ref<const Eigen::RowVectorXd>& a, double b) {
  const Index row = triangle_.rows() + waiting_;
  block_.row(row).head(a.size()) = a;
  block_(row, a.size()) = b;
  ++count_;
  if (++waiting_ == block_.rows() - triangle_.rows()) Fold();
}

void RowTriangle::Fold() {
  if (waiting_ == 0) return;
  const Index size = triangle_.rows();
  block_.topRows(size) = triangle_;
  Eigen::HouseholderQR<MatrixXd> qr(block_.topRows(size + waiting_));
  triangle_ = qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
  waiting_ = 0;
}

const MatrixXd& RowTriangle::triangle() {
  Fold();
  return triangle_;
}

double RowTriangle::rms(const Eigen::VectorXd& x) {
  if (count_ == 0) return 0;
  const Eigen::VectorXd e = triangle().leftCols(x.size()) * x - triangle().col(x.size());
  return e.norm() / std::sqrt(static_cast<double>(count_));
}

}  // namespace pliant
