#pragma once

#include <Eigen/Core>
#include <random>
#include <string_view>
#include <utility>

#include "pliant/controllers/qp_solver.h"

namespace pliant {

/// Problems on which dual methods are known to fail: degenerate, dependent, barely infeasible,
/// badly scaled. With small integers as data they are degenerate exactly, not but for round-off.
enum class Adversary {
  Random,                  ///< limits of all kinds, often infeasible
  DuplicateRows,           ///< each row three times, once with the other sign
  ZeroWidthBounds,         ///< x_lower = x_upper, for all variables in some
  ParallelRows,            ///< multiples of one normal with different limits
  VertexOfTwentyRows,      ///< all limits of 20 rows pass through one point
  DependentEqualities,     ///< more equality rows than their rank, consistent
  InconsistentEqualities,  ///< the same, one off by a part in a thousand
  ZeroRows,                ///< 0 ≤ 0ᵀx ≤ 0, and some that ask for 1
  BarelyInfeasible,        ///< a sum of rows asked for 1e-6 more than the rows allow
  BarelyFeasible,          ///< the same, 1e-6 less
  HeavyWeights,            ///< 1e8 : 1 in H
  PointOfManyEqualities,   ///< bounds and rows leave one point
};
inline constexpr int kAdversaries = 12;

inline constexpr std::string_view Name(Adversary kind) {
  constexpr std::string_view names[kAdversaries] = {"Random",
                                                    "DuplicateRows",
                                                    "ZeroWidthBounds",
                                                    "ParallelRows",
                                                    "VertexOfTwentyRows",
                                                    "DependentEqualities",
                                                    "InconsistentEqualities",
                                                    "ZeroRows",
                                                    "BarelyInfeasible",
                                                    "BarelyFeasible",
                                                    "HeavyWeights",
                                                    "PointOfManyEqualities"};
  return names[static_cast<int>(kind)];
}

class AdversaryMaker {
 public:
  explicit AdversaryMaker(unsigned seed) : draw_{seed} {}

  /// `integers`: data are small integers; otherwise all bits are used.
  QpProblem Make(Adversary kind, int n, bool integers) {
    integers_ = integers;
    switch (kind) {
      case Adversary::Random:
        return Random(n, Whole(0, 2 * n));
      case Adversary::DuplicateRows:
        return DuplicateRows(n);
      case Adversary::ZeroWidthBounds:
        return ZeroWidthBounds(n);
      case Adversary::ParallelRows:
        return ParallelRows(n);
      case Adversary::VertexOfTwentyRows:
        return Vertex(n);
      case Adversary::DependentEqualities:
        return Equalities(n, 0);
      case Adversary::InconsistentEqualities:
        return Equalities(n, 1.0 / 1024);
      case Adversary::ZeroRows:
        return ZeroRows(n);
      case Adversary::BarelyInfeasible:
        return Barely(n, 0x1p-20);
      case Adversary::BarelyFeasible:
        return Barely(n, -0x1p-20);
      case Adversary::HeavyWeights:
        return HeavyWeights(n);
      case Adversary::PointOfManyEqualities:
        return Point(n);
    }
    return {n, 0};
  }

 private:
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  int Whole(int from, int to) { return std::uniform_int_distribution<int>{from, to}(draw_); }
  double Number(int size) {
    if (integers_) return Whole(-size, size);
    return std::uniform_real_distribution<double>{-1.0 * size, 1.0 * size}(draw_);
  }
  Matrix Numbers(int rows, int columns, int size) {
    return Matrix::NullaryExpr(rows, columns, [&] { return Number(size); });
  }

  // H = BᵀB + I, g; rows and limits are still missing.
  QpProblem Objective(int n, int rows) {
    QpProblem qp{n, rows};
    const Matrix B = Numbers(n, n, 2);
    qp.H = B.transpose() * B;
    qp.H.diagonal().array() += 1;
    qp.g = Numbers(n, 1, 10);
    if (rows > 0) qp.A = Numbers(rows, n, 3);
    return qp;
  }

  QpProblem Random(int n, int rows) {
    QpProblem qp = Objective(n, rows);
    const auto set = [&](double& lower, double& upper) {
      const double middle = Number(2);
      const int kind = Whole(0, 4);
      if (kind != 0) lower = middle - std::abs(Number(2));
      if (kind != 1) upper = middle + std::abs(Number(2));
      if (kind == 2 && Whole(0, 3) == 0) upper = lower;
    };
    for (int i = 0; i < n; ++i) set(qp.x_lower(i), qp.x_upper(i));
    for (int i = 0; i < rows; ++i) set(qp.lower(i), qp.upper(i));
    return qp;
  }

  QpProblem DuplicateRows(int n) {
    const int rows = Whole(1, n);
    QpProblem qp = Random(n, 3 * rows);
    for (int i = 0; i < rows; ++i) {
      qp.A.row(rows + i) = qp.A.row(i);
      qp.A.row(2 * rows + i) = -qp.A.row(i);
      qp.lower(rows + i) = qp.lower(i);
      qp.upper(rows + i) = qp.upper(i);
      qp.lower(2 * rows + i) = -qp.upper(i);
      qp.upper(2 * rows + i) = -qp.lower(i);
    }
    return qp;
  }

  QpProblem ZeroWidthBounds(int n) {
    QpProblem qp = Random(n, Whole(0, n));
    const bool all = Whole(0, 1) == 0;
    for (int i = 0; i < n; ++i)
      if (all || Whole(0, 1) == 0) qp.x_lower(i) = qp.x_upper(i) = Number(2);
    return qp;
  }

  QpProblem ParallelRows(int n) {
    QpProblem qp = Random(n, 3 * n);
    for (int i = 0; i < 3 * n; ++i) {
      qp.A.row(i) = qp.A.row(i % 2);
      qp.A.row(i) *= std::ldexp(Whole(0, 1) == 0 ? 1 : -1, Whole(-2, 2));
    }
    return qp;
  }

  QpProblem Vertex(int n) {
    QpProblem qp = Objective(n, 20);
    const Vector vertex = Numbers(n, 1, 3);
    qp.g *= 10;
    qp.lower = qp.A * vertex;
    if (Whole(0, 2) == 0) qp.upper = qp.lower;  // dependent, and consistent but for round-off
    return qp;
  }

  QpProblem Equalities(int n, double off) {
    const int rank = Whole(1, n), rows = rank + Whole(1, 3);
    QpProblem qp = Objective(n, rows);
    const Vector point = Numbers(n, 1, 3);
    for (int i = rank; i < rows; ++i)
      qp.A.row(i) = Number(2) * qp.A.row(i % rank) + qp.A.row((i + 1) % rank);
    qp.lower = qp.A * point;
    qp.lower(rows - 1) += off * (1 + qp.A.row(rows - 1).cwiseAbs().sum());
    qp.upper = qp.lower;
    return qp;
  }

  QpProblem ZeroRows(int n) {
    QpProblem qp = Random(n, n + 3);
    for (int i = n; i < n + 3; ++i) {
      qp.A.row(i).setZero();
      qp.lower(i) = qp.upper(i) = 0;
    }
    if (Whole(0, 3) == 0) qp.upper(n + 1) = qp.lower(n + 1) = 1;
    return qp;
  }

  // Σ a_i x ≥ Σ upper_i + by, with a_i x ≤ upper_i
  QpProblem Barely(int n, double by) {
    const int rows = Whole(1, n);
    QpProblem qp = Objective(n, rows + 1);
    qp.upper.head(rows) = Numbers(rows, 1, 3);
    qp.A.row(rows) = qp.A.topRows(rows).colwise().sum();
    qp.lower(rows) = qp.upper.head(rows).sum() + by;
    return qp;
  }

  QpProblem HeavyWeights(int n) {
    QpProblem qp = Random(n, n);
    const Matrix J = Numbers(std::max(1, n - 1), n, 2);
    qp.H = 1e8 * J.transpose() * J;
    qp.H.diagonal().array() += 1;
    qp.g = -1e8 * J.transpose() * Numbers(static_cast<int>(J.rows()), 1, 3);
    return qp;
  }

  QpProblem Point(int n) {
    QpProblem qp = Objective(n, 2 * n);
    const Vector point = Numbers(n, 1, 3);
    qp.lower = qp.A * point;
    qp.upper.tail(n) = qp.lower.tail(n);
    for (int i = 0; i < n; ++i) (Whole(0, 1) == 0 ? qp.x_lower(i) : qp.x_upper(i)) = point(i);
    return qp;
  }

  std::mt19937 draw_;
  bool integers_ = false;
};

}  // namespace pliant
