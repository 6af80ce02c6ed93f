#include "pliant/estimators/wrist_torque.h"

#include <span>

namespace pliant {

WristTorque::WristTorque(const Options& o)
    : contact{this, "contact", Frame(o.frame)},
      dynamics{this, "dynamics", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      model_{o.model},
      link_{o.model.link_index(o.frame)} {
  Compute(torque).From(contact, dynamics).As(&WristTorque::Torque);
}

JointTorque WristTorque::Torque(const Wrench& F, const RobotDynamics& d) const {
  const Eigen::Matrix3d R_WS = LinkPose(model_, d, link_).rotation;
  const ContactForce in_world{
      .link = link_, .point = {0, 0, 0}, .force = R_WS * F.tail<3>(), .moment = R_WS * F.head<3>()};
  return ExternalTorque(model_, d, std::span(&in_world, 1));
}

}  // namespace pliant
