#pragma once

#include <string>

#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Keeps a point of a link from moving faster than v⁺ and its link from turning faster than ω⁺.
/// With u = v/‖v‖ the speed changes at uᵀ v̇, and
///
///   uᵀ (J q̈ + J̇ q̇) ≤ λ (v⁺ − ‖v‖)
///
/// lets it come up to v⁺ and not pass it. Along two axes across u, |v̇| ≤ λ v⁺: none sets out faster
/// than that from rest. Sampled and held every h ≤ 1/λ, turning adds to the speed within a sample,
/// and ‖v‖ ≤ v⁺ (1 + λ h): (1 + x (1 − x))² + 2 x² ≤ (1 + x)², x = λ h. The same of ω. Six rows,
/// the first three of ω.
///
/// Source: Celerier et al. 2025 (18), (24), for the norm of a velocity.
class FrameSpeedLimit final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string frame;                                ///< a link
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in its frame [m]
    double linear = kUnbounded;                       ///< v⁺ [m/s], > 0
    double angular = kUnbounded;                      ///< ω⁺ [rad/s], > 0
    double rate = 100;                                ///< λ [1/s], > 0
    int priority = 4;

    template <class F>
    void Parameters(F&& f) {
      f("frame", frame);
      f("point", point, "m");
      f("linear", linear, "m/s", kLimit);
      f("angular", angular, "rad/s", kLimit);
      f("rate", rate, "1/s", kPositive);
      f("priority", priority, "", Between(1, 100));
    }
  };
  static constexpr int kRows = 6;

  explicit FrameSpeedLimit(const Options& o);

  Input<RobotDynamics> dynamics;
  Output<AccelerationRows> rows;

 private:
  void Limit(AccelerationRows& out, const RobotDynamics& d) const;

  const Options o_;
  const int link_;
};

}  // namespace pliant
