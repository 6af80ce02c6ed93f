#include "pliant/analysis/consistent_inertia.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Theta = Eigen::Matrix<double, 10, 1>;
using Jacobian10 = Eigen::Matrix<double, 10, 10>;

/// P₀ = A Aᵀ.
Matrix4d Factor(const Inertial& prior) {
  const PseudoInertia P = PseudoInertiaOf(ParametersOf(prior));
  Eigen::LLT<Matrix4d> llt(P);
  const double least = 1e-9 * P.diagonal().maxCoeff();
  if (llt.info() != Eigen::Success || llt.matrixLLT().diagonal().minCoeff() < least) {
    PseudoInertia filled = P;
    filled.diagonal().head<3>().array() += 1e-6 * prior.mass;
    llt.compute(filled);
  }
  return llt.matrixL();
}

/// θ: the diagonal of U, then (0,1), (0,2), (1,2), (0,3), (1,3), (2,3).
Matrix4d Triangle(const Theta& theta) {
  Matrix4d U = theta.head<4>().array().exp().matrix().asDiagonal();
  U(0, 1) = theta[4];
  U(0, 2) = theta[5];
  U(1, 2) = theta[6];
  U(0, 3) = theta[7];
  U(1, 3) = theta[8];
  U(2, 3) = theta[9];
  return U;
}

constexpr std::array<std::array<int, 2>, 10> kPlaces{
    {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}, {2, 3}}};

InertialParameters ParametersAt(const Matrix4d& A, const Theta& theta) {
  const Matrix4d AU = A * Triangle(theta);
  return ParametersOf(PseudoInertia(AU * AU.transpose()));
}

/// ∂π/∂θ.
Jacobian10 SlopeAt(const Matrix4d& A, const Theta& theta) {
  const Matrix4d U = Triangle(theta);
  Jacobian10 slope;
  for (std::size_t k = 0; k < kPlaces.size(); ++k) {
    const auto [i, j] = kPlaces[k];
    Matrix4d dU = Matrix4d::Zero();
    dU(i, j) = i == j ? U(i, i) : 1;
    const Matrix4d half = A * dU * U.transpose() * A.transpose();
    slope.col(static_cast<Index>(k)) = ParametersOf(PseudoInertia(half + half.transpose()));
  }
  return slope;
}

/// The prior's residual of each θ is its factor times θ/σ₀.
Theta PriorWeights(double deviation) {
  Theta weights;
  weights << Theta::Constant(std::numbers::sqrt2);
  weights.head<4>().setConstant(2);
  return weights / deviation;
}

/// s (T (π(θ); f) − b).
class Rows final : public ceres::CostFunction {
 public:
  Rows(const MatrixXd& T, const VectorXd& b, const std::vector<Matrix4d>& factors, Index others,
       const double& s)
      : T_{T}, b_{b}, factors_{factors}, others_{others}, s_{s} {
    set_num_residuals(static_cast<int>(T.rows()));
    for (std::size_t k = 0; k < factors.size(); ++k) mutable_parameter_block_sizes()->push_back(10);
    if (others > 0) mutable_parameter_block_sizes()->push_back(static_cast<int32_t>(others));
  }

  bool Evaluate(double const* const* at, double* residuals, double** slopes) const override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<VectorXd> r(residuals, T_.rows());
    r = -b_;
    for (std::size_t k = 0; k < factors_.size(); ++k) {
      const Theta theta = Eigen::Map<const Theta>(at[k]);
      if (!(theta.head<4>().cwiseAbs().maxCoeff() < 100)) return false;  // exp would overflow
      const MatrixXd Tk = T_.middleCols(10 * static_cast<Index>(k), 10);
      r += Tk * ParametersAt(factors_[k], theta);
      if (slopes && slopes[k])
        Eigen::Map<RowMajor>(slopes[k], T_.rows(), 10) = s_ * Tk * SlopeAt(factors_[k], theta);
    }
    if (others_ > 0) {
      const std::size_t k = factors_.size();
      r += T_.rightCols(others_) * Eigen::Map<const VectorXd>(at[k], others_);
      if (slopes && slopes[k])
        Eigen::Map<RowMajor>(slopes[k], T_.rows(), others_) = s_ * T_.rightCols(others_);
    }
    r *= s_;
    return true;
  }

 private:
  const MatrixXd& T_;
  const VectorXd& b_;
  const std::vector<Matrix4d>& factors_;
  const Index others_;
  const double& s_;
};

/// w θ.
class Prior final : public ceres::SizedCostFunction<10, 10> {
 public:
  explicit Prior(const Theta& weights) : weights_{weights} {}
  bool Evaluate(double const* const* at, double* residuals, double** slopes) const override {
    Eigen::Map<Theta>{residuals} = weights_.cwiseProduct(Eigen::Map<const Theta>(at[0]));
    if (slopes && slopes[0])
      Eigen::Map<Eigen::Matrix<double, 10, 10, Eigen::RowMajor>>{slopes[0]} = weights_.asDiagonal();
    return true;
  }

 private:
  const Theta weights_;
};

/// m, c and I about c, as a column in the order of π.
InertialParameters Figures(const Inertial& i) {
  InertialParameters figures;
  const Eigen::Matrix3d& I = i.inertia;
  figures << i.mass, i.center, I(0, 0), I(0, 1), I(0, 2), I(1, 1), I(1, 2), I(2, 2);
  return figures;
}

Inertial FromFigures(const InertialParameters& x) {
  Inertial i{x[0], x.segment<3>(1), {}};
  i.inertia << x[4], x[5], x[6], x[5], x[7], x[8], x[6], x[8], x[9];
  return i;
}

/// ∂(m, c, I_c)/∂θ, by central differences: exact to some 1e-10 of the figures.
Jacobian10 FigureSlopes(const Matrix4d& A, const Theta& theta) {
  constexpr double h = 1e-5;
  Jacobian10 slopes;
  for (Index k = 0; k < 10; ++k) {
    const auto at = [&](double step) {
      return Figures(InertialOf(ParametersAt(A, theta + step * Theta::Unit(k))));
    };
    slopes.col(k) = (at(h) - at(-h)) / (2 * h);
  }
  return slopes;
}

}  // namespace

ConsistentFit FitConsistentInertia(const InertiaRows& rows, const std::vector<Inertial>& prior,
                                   double deviation, const std::vector<Index>& without) {
  Require(deviation > 0 && std::isfinite(deviation), "the prior's deviation must be > 0",
          deviation);
  const Index inertial = 10 * std::ssize(prior);
  std::vector<Index> others;  // columns of f that take part
  for (Index k = inertial; k < rows.T.cols(); ++k)
    if (!std::ranges::count(without, k)) others.push_back(k);
  MatrixXd T(rows.T.rows(), inertial + std::ssize(others));
  T << rows.T.leftCols(inertial), rows.T(Eigen::all, others);

  std::vector<Matrix4d> factors;
  for (const Inertial& i : prior) factors.push_back(Factor(i));
  std::vector<Theta> theta(prior.size(), Theta::Zero());
  VectorXd f = VectorXd::Zero(std::ssize(others));

  ceres::Problem problem;
  std::vector<double*> blocks;
  for (Theta& t : theta) blocks.push_back(t.data());
  if (f.size() > 0) blocks.push_back(f.data());
  double s = 1;
  problem.AddResidualBlock(new Rows(T, rows.b, factors, f.size(), s), nullptr, blocks);
  const Theta weights = PriorWeights(deviation);
  for (Theta& t : theta) problem.AddResidualBlock(new Prior(weights), nullptr, t.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  // Rows of high weight make a narrow valley that bends. With the weight raised by steps every
  // solution is near the next.
  const double far = rows.b.norm();
  for (s = std::min(1.0, 10 / std::max(far, 1e-300));; s = std::min(1.0, 10 * s)) {
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    Require(summary.IsSolutionUsable(), "the fit of consistent inertia failed: " + summary.message);
    if (s == 1) break;
  }

  // The Jacobian of all residuals, whose inverse square is the covariance of (θ, f).
  MatrixXd J = MatrixXd::Zero(T.rows() + inertial, T.cols());
  J.topRows(T.rows()) = T;
  for (std::size_t k = 0; k < prior.size(); ++k) {
    const Index column = 10 * static_cast<Index>(k);
    J.topRows(T.rows()).middleCols(column, 10) =
        T.middleCols(column, 10) * SlopeAt(factors[k], theta[k]);
    J.block(T.rows() + column, column, 10, 10) = weights.asDiagonal();
  }
  const VectorXd scale = J.colwise().norm().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::HouseholderQR<MatrixXd> qr(J * scale.cwiseInverse().asDiagonal());
  MatrixXd inverse = MatrixXd::Identity(J.cols(), J.cols());
  qr.matrixQR().topRows(J.cols()).triangularView<Eigen::Upper>().solveInPlace(inverse);
  inverse = (scale.cwiseInverse().asDiagonal() * inverse).eval();
  const MatrixXd covariance = inverse * inverse.transpose();

  ConsistentFit fit;
  fit.x = VectorXd::Zero(rows.T.cols());
  for (std::size_t k = 0; k < prior.size(); ++k) {
    const Index column = 10 * static_cast<Index>(k);
    const InertialParameters pi = ParametersAt(factors[k], theta[k]);
    fit.x.segment<10>(column) = pi;
    const Jacobian10 slopes = FigureSlopes(factors[k], theta[k]);
    const Jacobian10 after = slopes * covariance.block<10, 10>(column, column) * slopes.transpose();
    const Jacobian10 before =
        slopes * weights.cwiseInverse().cwiseAbs2().asDiagonal() * slopes.transpose();
    ConsistentInertia link;
    link.inertial = InertialOf(pi);
    link.deviation = FromFigures(after.diagonal().cwiseMax(0).cwiseSqrt());
    for (Index i = 0; i < 10; ++i)
      link.from_data[i] =
          before(i, i) > 0 ? std::clamp(1 - after(i, i) / before(i, i), 0.0, 1.0) : 0.0;
    fit.links.push_back(link);
  }
  fit.x(others) = f;
  return fit;
}

}  // namespace pliant
