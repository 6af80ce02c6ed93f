#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pliant/controllers/qp_solver.h"

namespace pliant {

/// Problems that a 7-joint arm poses at 1 kHz while it moves on sums of sines and is pushed now and
/// then; x = q̈:
///
///   min 1e4 ‖J q̈ − b‖² + ‖q̈ − p‖²,   dampers ≤ q̈ ≤ dampers,
///   −τ_max ≤ M q̈ + h ≤ τ_max,   n_cᵀ J_c q̈ ≥ −k_1 d_c − k_2 ḋ_c for points c of the arm
///
/// Links are point masses with an isotropic inertia, light at the wrist: cond M is 1e3 to 1e4. The
/// motion does not depend on the solutions, so all solvers see the same problems.
class ArmQpSequence {
 public:
  static constexpr int kJoints = 7;
  struct Options {
    int collision_rows = 0;
    double torque_scale = 0.5;  ///< of the limits 39, 39, 39, 39, 9, 9, 9 N·m
    double braking = 4;         ///< largest q̈ and collision acceleration that the dampers ask for
    double crowding = 0;        ///< by how much obstacles [m] and joint limits [rad] are nearer
  };

  explicit ArmQpSequence(const Options& o) : options_{o}, draw_{7} {
    std::uniform_real_distribution<double> uniform{-1, 1};
    for (int i = 0; i < kJoints; ++i)
      for (int k = 0; k < 3; ++k) {
        amplitude_[i][k] = 0.4 * uniform(draw_);
        frequency_[i][k] = 2.4 + 1.6 * uniform(draw_);
        phase_[i][k] = 3 * uniform(draw_);
      }
    for (int c = 0; c < o.collision_rows; ++c) {
      normal_.push_back(Vector3{uniform(draw_), uniform(draw_), uniform(draw_)}.normalized());
      on_link_.push_back(3 + c % 4);
      offset_.push_back(0.45 + 0.25 * uniform(draw_));
    }
  }

  QpProblem MakeProblem() const { return {kJoints, kJoints + options_.collision_rows}; }

  void Write(int tick, QpProblem& qp) const {
    const double t = 1e-3 * tick;
    Joint q, v, a;
    std::minstd_rand noise{static_cast<unsigned>(tick + 1)};
    noise.discard(10);
    std::uniform_real_distribution<double> encoder{-0.004, 0.004};
    for (int i = 0; i < kJoints; ++i) {
      q(i) = kRest[i];
      v(i) = a(i) = 0;
      for (int k = 0; k < 3; ++k) {
        const double w = frequency_[i][k], angle = w * t + phase_[i][k];
        q(i) += amplitude_[i][k] * std::sin(angle);
        v(i) += amplitude_[i][k] * w * std::cos(angle);
        a(i) -= amplitude_[i][k] * w * w * std::sin(angle);
      }
      v(i) += encoder(noise);
    }

    std::array<Vector3, kJoints> axis, origin, tip;
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Vector3 p = Vector3::Zero();
    for (int i = 0; i < kJoints; ++i) {
      const Vector3 local = i % 2 == 0 ? Vector3::UnitZ() : Vector3::UnitY();
      origin[i] = p;
      axis[i] = R * local;
      R = R * Eigen::AngleAxisd(q(i), local);
      p += R * Vector3(0.02, 0.01 * i, kLength[i]);
      tip[i] = p;
    }
    const auto jacobian = [&](const Vector3& point, int link) {
      Eigen::Matrix<double, 6, kJoints> J = Eigen::Matrix<double, 6, kJoints>::Zero();
      for (int i = 0; i <= link; ++i) J.col(i) << axis[i], axis[i].cross(point - origin[i]);
      return J;
    };
    Eigen::Matrix<double, kJoints, kJoints> M;
    Joint h = 0.3 * v;
    M.setZero();
    for (int k = 0; k < kJoints; ++k) {
      const Eigen::Matrix<double, 6, kJoints> Jk = jacobian((origin[k] + tip[k]) / 2, k);
      M += kMass[k] * Jk.bottomRows<3>().transpose() * Jk.bottomRows<3>() +
           kInertia[k] * Jk.topRows<3>().transpose() * Jk.topRows<3>();
      h += 9.81 * kMass[k] * Jk.row(5).transpose();
    }
    const Eigen::Matrix<double, 6, kJoints> J = jacobian(tip[kJoints - 1], kJoints - 1);

    // Every 0.4 s a push of 0.2 s, which the compliant task follows.
    const double since = std::fmod(t, 0.4);
    const double push = since < 0.2 ? std::sin(std::numbers::pi * since / 0.2) : 0;
    const double way = std::sin(17.0 * std::floor(t / 0.4));
    Eigen::Vector<double, 6> b = J * a;
    b += push * Eigen::Vector<double, 6>{8 * way, 5, -6, 14 * way, -10, 12 * std::cos(3 * way)};
    Joint posture = -20 * (q - Eigen::Map<const Joint>(kRest)) - 9 * v;

    const double range = 0.75 - options_.crowding;
    constexpr double kTaskWeight = 1e4;
    qp.H.noalias() = kTaskWeight * J.transpose() * J;
    qp.H.diagonal().array() += 1;
    qp.g.noalias() = -kTaskWeight * J.transpose() * b - posture;
    for (int i = 0; i < kJoints; ++i) {
      const double to_upper = kRest[i] + range - q(i), to_lower = kRest[i] - range - q(i);
      qp.x_upper(i) = std::clamp(60 * to_upper - 14 * v(i), -options_.braking, 30.0);
      qp.x_lower(i) = std::clamp(60 * to_lower - 14 * v(i), -30.0, options_.braking);
      const double torque = options_.torque_scale * kTorque[i];
      qp.lower(i) = -torque - h(i);
      qp.upper(i) = torque - h(i);
    }
    qp.A.topRows<kJoints>() = M;
    for (int c = 0; c < options_.collision_rows; ++c) {
      const Eigen::Matrix<double, 6, kJoints> Jc = jacobian(tip[on_link_[c]], on_link_[c]);
      const Joint row = Jc.bottomRows<3>().transpose() * normal_[c];
      const double distance = normal_[c].dot(tip[on_link_[c]]) + offset_[c] - options_.crowding;
      qp.A.row(kJoints + c) = row;
      qp.lower(kJoints + c) =
          std::min(-40 * std::max(distance, -0.02) - 12 * row.dot(v), options_.braking);
    }
  }

 private:
  using Vector3 = Eigen::Vector3d;
  using Joint = Eigen::Vector<double, kJoints>;
  static constexpr double kRest[kJoints] = {0, 0.6, 0, 1.2, 0, 0.8, 0};
  static constexpr double kLength[kJoints] = {0.28, 0.21, 0.21, 0.21, 0.21, 0.1, 0.12};
  static constexpr double kMass[kJoints] = {1.4, 1.2, 1.2, 0.9, 0.7, 0.7, 0.5};
  static constexpr double kInertia[kJoints] = {4e-3, 4e-3, 4e-3, 2e-3, 1e-3, 1e-3, 5e-4};
  static constexpr double kTorque[kJoints] = {39, 39, 39, 39, 9, 9, 9};

  Options options_;
  std::mt19937 draw_;
  double amplitude_[kJoints][3], frequency_[kJoints][3], phase_[kJoints][3];
  std::vector<Vector3> normal_;
  std::vector<int> on_link_;
  std::vector<double> offset_;
};

/// A free arm (0 to 3 limits active), one among limits (mostly 1 to 4), one among more rows, and
/// one whose torques cannot do what its dampers ask for on a fifth of the ticks.
inline const ArmQpSequence::Options kFreeArm{};
inline const ArmQpSequence::Options kLimitedArm{
    .collision_rows = 10, .torque_scale = 0.5, .braking = 8, .crowding = 0.25};
inline const ArmQpSequence::Options kCrowdedArm{
    .collision_rows = 20, .torque_scale = 0.5, .braking = 8, .crowding = 0.2};
inline const ArmQpSequence::Options kOverloadedArm{
    .collision_rows = 10, .torque_scale = 0.3, .braking = 16, .crowding = 0.41};

/// Problems of a whole body that moves smoothly: tasks J_k(t) with weights 1e4 : 1, equality rows
/// (the dynamics and the contacts), other rows, bounds.
class BodyQpSequence {
 public:
  struct Options {
    int variables;
    int rows;
    int equalities;
  };

  explicit BodyQpSequence(const Options& o) : options_{o} {
    std::mt19937 draw{11};
    std::normal_distribution<double> normal;
    const auto matrix = [&](int rows) {
      return Eigen::MatrixXd::NullaryExpr(rows, o.variables, [&] { return normal(draw); }).eval();
    };
    const int tasks = o.variables / 3;
    for (int k = 0; k < 3; ++k) {
      task_[k] = matrix(tasks);
      row_[k] = matrix(o.rows);
      wish_[k] = Eigen::VectorXd::NullaryExpr(o.variables, [&] { return 3 * normal(draw); });
    }
  }

  QpProblem MakeProblem() const { return {options_.variables, options_.rows}; }

  void Write(int tick, QpProblem& qp) const {
    const double t = 1e-3 * tick;
    const double c = 0.3 * std::cos(1.3 * t), s = 0.3 * std::sin(0.9 * t);
    const Eigen::MatrixXd J = task_[0] + c * task_[1] + s * task_[2];
    const Eigen::VectorXd wish =
        wish_[0] * std::sin(2 * t) + wish_[1] * std::cos(1.7 * t) + wish_[2] * std::sin(3.1 * t);
    qp.H.noalias() = 1e4 * J.transpose() * J;
    qp.H.diagonal().array() += 1;
    qp.g.noalias() = -1e4 * J.transpose() * (J * wish) - wish;
    qp.A = row_[0] + s * row_[1] - c * row_[2];
    for (int i = 0; i < options_.rows; ++i) {
      const double at = 2 * std::sin(1.1 * t + i);
      const bool equality = i < options_.equalities;
      const double width = equality ? 0 : 7 * std::sqrt(options_.variables);
      qp.lower(i) = at - width;
      qp.upper(i) = at + width;
    }
    qp.x_lower.setConstant(-10);
    qp.x_upper.setConstant(10);
  }

 private:
  Options options_;
  std::array<Eigen::MatrixXd, 3> task_, row_;
  std::array<Eigen::VectorXd, 3> wish_;
};

}  // namespace pliant
