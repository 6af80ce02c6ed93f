#pragma once

#include <algorithm>
#include <limits>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// Up to 6 numbers of a task, angular part first where there is one.
using TaskVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;
using TaskMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// What a task wants of the joint accelerations, as a term of a least-squares problem:
///
///   w ‖A q̈ − b‖²
///
/// A is m×n and b has m elements, m ≤ max(6, kMaxJoints). Made once at its size, then only written
/// in place.
struct Objective {
  static constexpr int kMaxRows = std::max(6, kMaxJoints);
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxJoints>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;

  using Space = Joints;
  static constexpr Quantity quantity{"objective", ""};

  Matrix A;
  Vector b;
  double weight = 0;

  /// A term of m rows that wants nothing.
  static Objective Zero(int rows, int joints) {
    return {Matrix::Zero(rows, joints), Vector::Zero(rows), 0};
  }

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("A", A, "");
    f("b", b, "");
    f("weight", weight, "");
  }
};

/// lower ≤ q̈ ≤ upper, element by element [rad/s²]; ∓∞ where there is no bound.
struct AccelerationBounds {
  using Space = Joints;
  static constexpr Quantity quantity{"acceleration bounds", "rad/s²"};

  PerJoint lower, upper;

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("lower", lower, "rad/s²");
    f("upper", upper, "rad/s²");
  }
};

/// lower ≤ A q̈ ≤ upper, row by row; ∓∞ where there is no bound. A is m×n, m ≤ kMaxRows. Made once
/// at its size, then only written in place.
struct AccelerationRows {
  static constexpr int kMaxRows = 64;
  using Matrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxRows, kMaxJoints>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxRows, 1>;

  using Space = Joints;
  static constexpr Quantity quantity{"acceleration rows", ""};

  Matrix A;
  Vector lower, upper;
  int priority = 2;  ///< 1, 2, …: where not all can hold, larger numbers give way first

  /// Rows that bound nothing.
  static AccelerationRows None(int rows, int joints, int priority) {
    const Vector infinite = Vector::Constant(rows, std::numeric_limits<double>::infinity());
    return {Matrix::Zero(rows, joints), -infinite, infinite, priority};
  }

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("A", A, "");
    f("lower", lower, "");
    f("upper", upper, "");
    f("priority", priority, "");
  }
};

}  // namespace pliant
