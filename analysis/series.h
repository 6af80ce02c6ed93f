#pragma once

#include <Eigen/Core>

namespace pliant {

/// Numbers over time, a column per sample.
using Series = Eigen::MatrixXd;

/// The greatest element; not a number if one of them is not.
template <class D>
double Largest(const Eigen::DenseBase<D>& x) {
  return x.template maxCoeff<Eigen::PropagateNaN>();
}

/// The angular and the linear part of a task, 6 rows.
inline Series Angular(const Series& task) { return task.topRows<3>(); }
inline Series Linear(const Series& task) { return task.bottomRows<3>(); }

/// The norm of each sample.
inline Eigen::VectorXd Norms(const Series& all) { return all.colwise().norm().transpose(); }

}  // namespace pliant
