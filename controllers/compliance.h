#pragma once

#include <Eigen/Core>
#include <string_view>

#include "pliant/controllers/objective.h"

/// Γ, the compliance of a task: which part of the acceleration that a push would bring the task
/// lets through. Symmetric positive semi-definite; each eigenvector is a direction with a share.
namespace pliant {

/// Whether Γ is a finite, symmetric positive semi-definite matrix of that size. No heap, no
/// exceptions.
bool IsCompliance(const Eigen::Ref<const Eigen::MatrixXd>& gamma, Eigen::Index size);

/// Throws unless it is; `name` and `symbol` stand in messages.
void RequireCompliance(const Eigen::Ref<const Eigen::MatrixXd>& gamma, Eigen::Index size,
                       std::string_view name = "compliance", std::string_view symbol = "Γ");

/// The matrix of `size` rows that is meant: nothing is 0, a number γ is γ I, a column is the
/// diagonal. Throws unless it is a compliance.
template <class Matrix>
Matrix ComplianceOf(const Matrix& given, Eigen::Index size, std::string_view name = "compliance",
                    std::string_view symbol = "Γ") {
  Matrix gamma = given;
  if (given.size() == 0) gamma = Matrix::Zero(size, size);
  if (given.size() == 1) gamma = given(0, 0) * Matrix::Identity(size, size);
  if (given.cols() == 1 && given.rows() == size) {
    gamma = Matrix::Zero(size, size);
    gamma.diagonal() = given.col(0);
  }
  RequireCompliance(gamma, size, name, symbol);
  return gamma;
}

/// R Γ Rᵀ, block by block of three rows: Γ given in axes whose directions are the columns of R.
TaskMatrix InAxes(const Eigen::Matrix3d& R, const TaskMatrix& gamma);

}  // namespace pliant
