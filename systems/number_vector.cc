#include "pliant/systems/number_vector.h"

namespace pliant::internal {

namespace {

std::string Shape(Eigen::Index rows, Eigen::Index cols) { return Text(rows) + "×" + Text(cols); }

}  // namespace

void RequireShape(std::string_view name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                  Eigen::Index cols, std::string_view why) {
  if (matrix.rows() != rows || matrix.cols() != cols)
    throw Error(std::string(name) + " must be " + Shape(rows, cols) + ", " + std::string(why) +
                ", got " + Shape(matrix.rows(), matrix.cols()));
  if (!matrix.allFinite()) throw Error(std::string(name) + " must be finite");
}

}  // namespace pliant::internal
