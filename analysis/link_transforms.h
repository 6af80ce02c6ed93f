#pragma once

#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"

namespace pliant::internal {

/// A link and the link it hangs on.
struct LinkTransform {
  std::string parent, child;
  Pose pose;  ///< X_PC
};

/// Where every link but the root is, seen from the link its joint hangs on. RobotModel keeps no
/// fixed joints: a link that is fixed to others is seen from the one that moves them, or from the
/// root.
class LinkTransforms {
 public:
  explicit LinkTransforms(RobotModel model);

  const RobotModel& model() const { return model_; }
  /// At joint positions in the order of the model.
  const std::vector<LinkTransform>& At(const JointPosition& q);

 private:
  struct Edge {
    int parent, child;
  };

  const RobotModel model_;
  RobotDynamics dynamics_;
  std::vector<Edge> edges_;
  std::vector<LinkTransform> transforms_;
};

}  // namespace pliant::internal
