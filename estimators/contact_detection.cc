#include "pliant/estimators/contact_detection.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

/// By how many joints stand between them and the world; those with as many in the model's order.
std::vector<int> OutwardJoints(const RobotModel& model) {
  std::vector<int> depth(model.bodies().size());
  std::vector<std::pair<int, int>> joints;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const Body& body = model.bodies()[i];
    depth[i] = body.parent < 0 ? 0 : depth[static_cast<std::size_t>(body.parent)] + 1;
    joints.emplace_back(depth[i], body.joint);
  }
  std::ranges::sort(joints);
  std::vector<int> outward;
  for (const auto& [_, joint] : joints) outward.push_back(joint);
  return outward;
}

std::vector<int> ChildLinks(const RobotModel& model) {
  std::vector<int> links;
  for (const Joint& joint : model.joint_data()) links.push_back(joint.child);
  return links;
}

bool Has(JointBits bits, int joint) { return (bits >> joint & 1U) != 0; }

}  // namespace

ContactDetection::ContactDetection(const Options& o)
    : residual{this, "residual", o.model.joints()},
      felt{this, "felt"},
      touched{this, "touched"},
      link{this, "link", {}, -1},
      level{this, "level"},
      c_{o.threshold},
      release_{o.release},
      outward_{OutwardJoints(o.model)},
      child_{ChildLinks(o.model)} {
  RequireEachInRange("threshold", o.threshold, "N·m", kPositive, o.model.joints());
  RequireInRange("", "release", o.release, "", Between(0, 1));
  Every(o.period).Compute(felt).From(felt, residual).As(&ContactDetection::Feel);
  Compute(touched).From(felt).As([](const JointBits& bits) { return bits != 0; });
  Compute(link).From(felt).As(&ContactDetection::Isolate);
  Compute(level).From(residual).As(&ContactDetection::Level);
}

JointBits ContactDetection::Feel(const JointBits& last, const JointTorque& r) const {
  JointBits now = 0;
  for (int i = 0; i < r.size(); ++i)
    if (std::abs(r(i)) > c_(i) || (Has(last, i) && std::abs(r(i)) >= release_ * c_(i)))
      now |= 1U << i;
  return now;
}

int ContactDetection::Isolate(const JointBits& bits) const {
  const auto outermost = std::find_if(outward_.rbegin(), outward_.rend(),
                                      [bits](int joint) { return Has(bits, joint); });
  return outermost == outward_.rend() ? -1 : child_[static_cast<std::size_t>(*outermost)];
}

double ContactDetection::Level(const JointTorque& r) const {
  return r.cwiseAbs().cwiseQuotient(c_).maxCoeff();
}

}  // namespace pliant
