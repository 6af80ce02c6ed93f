#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/tests/fuzz/targets.h"

namespace pliant::fuzz {

bool Urdf(const std::string& bytes) {
  return Takes([&] {
    const RobotModel model = RobotModel::FromUrdfText(bytes);
    Check(model.size() > 0, "a robot has a joint");
    for (int b = 0; b < std::ssize(model.bodies()); ++b)
      Check(model.bodies()[static_cast<std::size_t>(b)].parent < b, "parents come first");
    for (const Joint& joint : model.joint_data())
      Check(joint.lower <= joint.upper, "a joint's limits are in order");
    const JointPosition q(JointPosition::Zero(model.joints())
                              .cwiseMax(model.lower_limit())
                              .cwiseMin(model.upper_limit()));
    RobotDynamics dynamics(model);
    ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), dynamics);
    Check(dynamics.M.allFinite() && dynamics.gravity.allFinite(), "a robot at rest has a weight");
  });
}

}  // namespace pliant::fuzz
