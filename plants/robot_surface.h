#pragma once

#include <span>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/plants/solid.h"

namespace pliant {

/// The surface of a robot: the collision shapes of its links.
class RobotSurface {
 public:
  struct Part {
    int link;     ///< index in the model
    int body;     ///< that carries it, −1: the world
    Solid solid;  ///< in the frame of the body
  };

  /// Throws if no link of the model has a shape.
  explicit RobotSurface(const RobotModel& model);

  std::span<const Part> parts() const { return parts_; }
  const Part& part(int index) const { return parts_[static_cast<std::size_t>(index)]; }
  int size() const { return static_cast<int>(parts_.size()); }

  /// Solids to place them in.
  std::vector<Solid> Solids() const;
  /// Where the parts are, seen from a frame C at X_WC, all faces `margin` further out. No heap.
  void Place(const RobotDynamics& d, const Pose& X_WC, double margin,
             std::span<Solid> placed) const;

  /// The point of a link's surface that is nearest to x, `placed` being the parts and x in their
  /// frame; the distance is ∞ for a link without a shape.
  SurfacePoint NearestOnLink(int link, std::span<const Solid> placed,
                             const Eigen::Vector3d& x) const;

 private:
  std::vector<Part> parts_;
};

}  // namespace pliant
