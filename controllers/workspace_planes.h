#pragma once

#include <string>
#include <vector>

#include "pliant/controllers/objective.h"
#include "pliant/controllers/velocity_damper.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// A half of the world: nᵀ p ≥ c.
struct HalfSpace {
  Eigen::Vector3d normal = Eigen::Vector3d::Constant(kToBeGiven);  ///< n, of any length > 0
  Eigen::Vector3d point = Eigen::Vector3d::Constant(kToBeGiven);   ///< on its plane [m]

  template <class F>
  void Parameters(F&& f) {
    f("normal", normal);
    f("point", point, "m");
  }
};

/// Keeps a point of a link inside half spaces by a velocity damper: with e = nᵀ p − c,
///
///   nᵀ (J q̈ + J̇ q̇) ≥ −λ ė − λ²/(4M²) (e − d_s)
///
/// a row for each plane.
///
/// Source: Celerier et al. 2025 (24), with the distance to a plane.
class WorkspacePlanes final : public Block {
 public:
  static constexpr int kMaxPlanes = TaskVector::MaxRowsAtCompileTime;

  struct Options {
    RobotModel model;
    std::string frame;                                ///< a link
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< p, in its frame [m]
    std::vector<HalfSpace> planes = {};               ///< one to kMaxPlanes
    double safety_distance = 0;                       ///< d_s [m], ≥ 0
    VelocityDamper damper = {};
    int priority = 3;

    template <class F>
    void Parameters(F&& f) {
      f("frame", frame);
      f("point", point, "m");
      f("planes", planes);
      f("safety_distance", safety_distance, "m", kNotNegative);
      f("damper", damper);
      f("priority", priority, "", Between(1, 100));
    }
  };

  explicit WorkspacePlanes(const Options& o);

  Input<RobotDynamics> dynamics;
  Output<TaskVector> distance;  ///< e of each plane [m]
  Output<AccelerationRows> rows;

 private:
  FrameDynamics Find(const RobotDynamics& d) const;
  TaskVector Measure(const FrameDynamics& at) const;
  void Limit(AccelerationRows& out, const FrameDynamics& at, const TaskVector& distance) const;

  const Options o_;
  const int link_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> offsets_;  // c
  Output<FrameDynamics> at_;
};

}  // namespace pliant
