#include "pliant/analysis/link_transforms.h"

#include <algorithm>
#include <utility>

namespace pliant::internal {
namespace {

/// The world is the frame of the root link.
bool IsAtTheWorld(const Link& link) {
  return link.body < 0 && link.pose.position.isZero(0) && link.pose.rotation.isIdentity(0);
}

}  // namespace

LinkTransforms::LinkTransforms(RobotModel model) : model_{std::move(model)}, dynamics_{model_} {
  const auto links = model_.links();
  const auto joints = model_.joint_data();
  const auto root = static_cast<int>(std::ranges::find_if(links, IsAtTheWorld) - links.begin());
  for (int child = 0; child < static_cast<int>(links.size()); ++child) {
    if (child == root) continue;
    const auto moved_by = std::ranges::find(joints, child, &Joint::child);
    const int body = model_.link(child).body;
    const int parent =
        moved_by != joints.end() ? moved_by->parent
        : body < 0               ? root
                   : model_.joint(model_.bodies()[static_cast<std::size_t>(body)].joint).child;
    edges_.push_back({parent, child});
    transforms_.push_back({model_.link(parent).name, model_.link(child).name, {}});
  }
}

const std::vector<LinkTransform>& LinkTransforms::At(const JointPosition& q) {
  ComputeDynamics(model_, q, JointVelocity::Zero(model_.joints()), dynamics_);
  for (std::size_t i = 0; i < edges_.size(); ++i)
    transforms_[i].pose = LinkPose(model_, dynamics_, edges_[i].parent).inverse() *
                          LinkPose(model_, dynamics_, edges_[i].child);
  return transforms_;
}

}  // namespace pliant::internal
