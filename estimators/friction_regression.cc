#include "pliant/estimators/friction_regression.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Dense>
#include <limits>

namespace pliant::internal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int kMostParameters = 9;
constexpr double kHuber = 1.345, kCauchy = 2.385;
constexpr double kLeastSingularValue = 0.005;

}  // namespace

Influence InfluenceOf(FrictionLoss loss, double u) {
  const double a = std::abs(u);
  if (loss == FrictionLoss::Huber && a > kHuber)
    return {2 * kHuber * a - kHuber * kHuber, std::copysign(kHuber, u), 0};
  if (loss == FrictionLoss::Cauchy) {
    const double k2 = kCauchy * kCauchy, t = 1 + u * u / k2;
    return {k2 * std::log(t), u / t, (2 - t) / (t * t)};
  }
  return {u * u, u, 1};
}

namespace {

/// Some of the samples, as one residual block of Ceres: its loss acts on blocks, so the weight of
/// each sample is inside, √ρ(u) with the sign of u.
class Block final : public ceres::CostFunction {
 public:
  Block(const Shape& shape, FrictionLoss loss, double scale, const double* velocity,
        const double* torque, int count)
      : shape_{shape}, loss_{loss}, scale_{scale}, velocity_{velocity}, torque_{torque} {
    set_num_residuals(count);
    mutable_parameter_block_sizes()->push_back(shape.size());
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const int p = shape_.size();
    double J[kMostParameters];
    for (int k = 0; k < num_residuals(); ++k) {
      const bool wanted = jacobians && jacobians[0];
      const double u = (torque_[k] - shape_(x[0], velocity_[k], wanted ? J : nullptr)) / scale_;
      const Influence influence = InfluenceOf(loss_, u);
      const double root = std::sqrt(influence.rho);
      residuals[k] = std::copysign(root, u);
      if (!wanted) continue;
      const double slope = root > 1e-8 ? std::abs(influence.psi) / root : 1;
      for (int i = 0; i < p; ++i) jacobians[0][k * p + i] = -slope * J[i] / scale_;
    }
    return true;
  }

 private:
  const Shape shape_;
  const FrictionLoss loss_;
  const double scale_;
  const double *velocity_, *torque_;
};

}  // namespace

void Solve(const Shape& shape, FrictionLoss loss, double scale, const VectorXd& velocity,
           const VectorXd& torque, VectorXd& x) {
  constexpr Index kInBlock = 1000;
  ceres::Problem problem;
  for (Index k = 0; k < velocity.size(); k += kInBlock) {
    const auto count = static_cast<int>(std::min(kInBlock, velocity.size() - k));
    problem.AddResidualBlock(
        new Block(shape, loss, scale, velocity.data() + k, torque.data() + k, count), nullptr,
        x.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type =
      velocity.size() > 10'000 ? ceres::DENSE_NORMAL_CHOLESKY : ceres::DENSE_QR;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-12;
  options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
}

VectorXd Residuals(const Shape& shape, const VectorXd& x, const VectorXd& velocity,
                   const VectorXd& torque) {
  VectorXd r(velocity.size());
  for (Index k = 0; k < r.size(); ++k) r(k) = torque(k) - shape(x.data(), velocity(k), nullptr);
  return r;
}

VectorXd Thinned(const VectorXd& all, Index most) {
  const Index stride = (all.size() + most - 1) / most;
  if (stride <= 1) return all;
  return all(Eigen::seq(0, Eigen::last, stride));
}

namespace {

double ScaleOf(const VectorXd& r) {
  const VectorXd a = r.cwiseAbs();
  const double median = 1.4826 * MedianOf({a.data(), a.data() + a.size()});
  // More than half of exact data fits exactly.
  return std::max(median, 1e-12 + 1e-9 * a.maxCoeff());
}

/// A start: of a grid of ω_s the one whose linear fit has the least sum of |r|, by weights that
/// turn least squares into it.
VectorXd Start(const Shape& shape, const VectorXd& velocity, const VectorXd& torque) {
  const VectorXd speed = velocity.cwiseAbs();
  double slow = speed.maxCoeff();
  for (const double v : speed)
    if (v > 0) slow = std::min(slow, v);
  const double from = std::log(0.5 * slow), to = std::log(0.7 * speed.maxCoeff());
  const int grid = shape.stribeck ? 16 : 1, p = shape.size();
  VectorXd best;
  double least = std::numeric_limits<double>::infinity();
  for (int g = 0; g < grid; ++g) {
    VectorXd x = VectorXd::Zero(p);
    const double log_speed = from + (to - from) * g / 15.0;
    for (int d = 0; shape.stribeck && d < (shape.separate ? 2 : 1); ++d)
      x(d * shape.each() + 3) = log_speed;
    // Linear in all but log ω_s, whose column is left out.
    VectorXd weights = VectorXd::Ones(velocity.size());
    double sum = 0;
    for (int iteration = 0; iteration < 6; ++iteration) {
      MatrixXd N = MatrixXd::Zero(p, p);
      VectorXd b = VectorXd::Zero(p), J(p);
      for (Index k = 0; k < velocity.size(); ++k) {
        shape(x.data(), velocity(k), J.data());
        for (int i = 3; shape.stribeck && i < p; i += 4)
          if (i < (shape.separate ? 8 : 4)) J(i) = 0;
        N.noalias() += weights(k) * J * J.transpose();
        b.noalias() += weights(k) * torque(k) * J;
      }
      VectorXd solved = N.completeOrthogonalDecomposition().solve(b);
      for (int i = 3; shape.stribeck && i < (shape.separate ? 8 : 4); i += 4) solved(i) = log_speed;
      x = solved;
      const VectorXd r = Residuals(shape, x, velocity, torque);
      const double scale = ScaleOf(r);
      sum = r.cwiseAbs().sum();
      weights = r.unaryExpr([&](double e) { return 1 / std::max(std::abs(e), 0.3 * scale); });
    }
    if (sum < least) {
      least = sum;
      best = x;
    }
  }
  return best;
}

/// x and σ, with σ of the residuals of x.
void Iterate(const Shape& shape, const FrictionFitOptions& o, const VectorXd& velocity,
             const VectorXd& torque, VectorXd& x, double& scale) {
  for (int round = 0; round < 8; ++round) {
    const double before = scale;
    Solve(shape, o.loss, scale, velocity, torque, x);
    if (o.scale > 0 || o.loss == FrictionLoss::None) break;
    scale = ScaleOf(Residuals(shape, x, velocity, torque));
    if (std::abs(scale - before) < 1e-3 * scale) break;
  }
  if (o.scale <= 0) scale = ScaleOf(Residuals(shape, x, velocity, torque));
}

}  // namespace

Solution SolutionOf(const Shape& shape, const FrictionFitOptions& o, const VectorXd& velocity,
                    const VectorXd& torque) {
  // The start and the scale do not need all of a million samples.
  const VectorXd v = Thinned(velocity, 20'000), y = Thinned(torque, 20'000);
  Solution s{Start(shape, Thinned(velocity, 1'500), Thinned(torque, 1'500)), 0};
  s.scale = o.scale > 0 ? o.scale : ScaleOf(Residuals(shape, s.x, v, y));
  Iterate(shape, o, v, y, s.x, s.scale);
  if (v.size() < velocity.size()) Iterate(shape, o, velocity, torque, s.x, s.scale);
  return s;
}

namespace {

/// Sums over blocks of `length` neighbours that lie in one stretch; a block that is not full counts
/// too.
template <class Row>
std::vector<VectorXd> BlockSums(Index count, const std::vector<Index>& begin, Index length, int p,
                                const Row& row) {
  std::vector<VectorXd> sums;
  std::size_t stretch = 0;
  Index in_block = length;
  for (Index k = 0; k < count; ++k) {
    bool fresh = in_block == length;
    while (stretch < begin.size() && begin[stretch] <= k) {
      fresh = fresh || begin[stretch] == k;
      ++stretch;
    }
    if (fresh) {
      sums.push_back(VectorXd::Zero(p));
      in_block = 0;
    }
    row(k, sums.back());
    ++in_block;
  }
  return sums;
}

}  // namespace

Blocking BlockingOf(const VectorXd& psi, const std::vector<Index>& begin) {
  constexpr Index kLeastBlocks = 48;
  std::vector<double> variance;
  std::vector<Index> blocks;
  const double total = psi.squaredNorm();
  if (!(total > 0)) return {};
  for (Index length = 1; psi.size() / length >= kLeastBlocks || length == 1; length *= 2) {
    const std::vector<VectorXd> sums =
        BlockSums(psi.size(), begin, length, 1, [&](Index k, VectorXd& sum) { sum(0) += psi(k); });
    double squares = 0;
    for (const VectorXd& sum : sums) squares += sum(0) * sum(0);
    variance.push_back(squares / total);
    blocks.push_back(std::ssize(sums));
  }
  Blocking result;
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const double spread = 2 * std::sqrt(2.0 / static_cast<double>(blocks[i]));
    bool flat = true;
    for (std::size_t k = i + 1; k < variance.size(); ++k) {
      const double of_k = 2 * std::sqrt(2.0 / static_cast<double>(blocks[k]));
      flat = flat && std::abs(variance[k] / variance[i] - 1) < spread + of_k;
    }
    result = {Index{1} << i, variance[i]};
    if (flat) break;
  }
  // Sums of blocks that just stop growing lack what neighbours share across their ends.
  if (result.length > 1 && psi.size() / (2 * result.length) >= kLeastBlocks) {
    result.length *= 2;
    result.inefficiency = variance[static_cast<std::size_t>(std::log2(result.length))];
  }
  return result;
}

double Student95(double degrees) {
  // A table where the series of Abramowitz & Stegun 26.7.5 is off by more than 0.1 %.
  constexpr double kFew[] = {12.706205, 4.302653, 3.182446, 2.776445, 2.570582,
                             2.446912,  2.364624, 2.306004, 2.262157, 2.228139};
  const double n = std::max(degrees, 1.0);
  if (n < 11) return kFew[static_cast<int>(n) - 1];
  const double z = kNormal95, z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n);
}

Certainty CertaintyOf(const Shape& shape, FrictionLoss loss, const Solution& at,
                      const VectorXd& velocity, const VectorXd& torque,
                      const std::vector<Index>& begin, Index block) {
  const int p = shape.size();
  MatrixXd JJ = MatrixXd::Zero(p, p), A = JJ, B = JJ;
  double slopes = 0;
  VectorXd J(p);
  const auto row = [&](Index k, VectorXd& sum) {
    const double y = shape(at.x.data(), velocity(k), J.data());
    const Influence influence = InfluenceOf(loss, (torque(k) - y) / at.scale);
    JJ.noalias() += J * J.transpose();
    A.noalias() += influence.slope * J * J.transpose();
    slopes += influence.slope;
    sum.noalias() += influence.psi * J;
  };
  const std::vector<VectorXd> sums = BlockSums(velocity.size(), begin, block, p, row);
  for (const VectorXd& sum : sums) B.noalias() += sum * sum.transpose();
  const auto n = static_cast<double>(sums.size());
  B *= n / std::max(1.0, n - p);
  slopes /= static_cast<double>(velocity.size());

  Certainty result;
  result.quantile = Student95(n - p);
  result.unknown.assign(static_cast<std::size_t>(p), false);
  VectorXd unit(p);
  for (int i = 0; i < p; ++i) {
    result.unknown[static_cast<std::size_t>(i)] = !(JJ(i, i) > 1e-20);
    unit(i) = JJ(i, i) > 1e-20 ? 1 / std::sqrt(JJ(i, i)) : 1;
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(unit.asDiagonal() * JJ * unit.asDiagonal());
  std::vector<Index> seen;
  for (int i = 0; i < p; ++i) {
    if (eigen.eigenvalues()(i) > kLeastSingularValue * kLeastSingularValue) {
      seen.push_back(i);
      continue;
    }
    for (int j = 0; j < p; ++j)
      if (std::abs(eigen.eigenvectors()(j, i)) > 0.1)
        result.unknown[static_cast<std::size_t>(j)] = true;
  }
  const MatrixXd V = unit.asDiagonal() * eigen.eigenvectors()(Eigen::all, seen);
  Eigen::LLT<MatrixXd> within(V.transpose() * A * V);
  // Far outliers bend Cauchy's loss down; their mean bend never does.
  if (within.info() != Eigen::Success)
    within.compute(std::max(slopes, 1e-3) * V.transpose() * JJ * V);
  const MatrixXd bread = V * within.solve(MatrixXd(V.transpose()));
  result.covariance = at.scale * at.scale * bread * B * bread;
  return result;
}

}  // namespace pliant::internal
