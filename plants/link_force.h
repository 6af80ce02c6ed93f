#pragma once

#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A force F at a point x of a link. Where it comes from says what it is: `Pulse<Force>` is a blow,
/// `Sine<Force>` a shaker, `Table<Force>` a recorded push.
///
///   pulse.y ─▶ force.force,   force.contact ─▶ plant.contacts
///   plant.motion ─▶ force.motion
///
/// It stores nothing and dissipates nothing: P = Fᵀ ẋ is all that it gives to the arm. A force
/// does not depend on the motion; only `power` reads it.
class LinkForce final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string link;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< x, in the link's frame [m]
  };

  explicit LinkForce(const Options& o);

  Input<Force> force;           ///< F, world axes
  Input<RobotDynamics> motion;  ///< of the plant
  Output<ContactForce> contact;
  Output<double> energy;       ///< 0 [J]
  Output<double> dissipation;  ///< 0 [W]
  Output<double> power;        ///< Fᵀ ẋ, what the source of the force gives [W]

 private:
  ContactForce Act(const Force& F) const;
  double Drive(const Force& F, const RobotDynamics& d) const;

  const RobotModel model_;
  const int link_;
  const Eigen::Vector3d point_;
};

}  // namespace pliant
