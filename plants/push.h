#pragma once

#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A scripted push: a force of constant direction at a point of a link, that rises and falls along
/// a raised cosine,
///
///   F(t) = F ½ (1 − cos(π s)),   s = clamp((t − start)/edge, 0, 1)
///
/// and mirrored at the end. It is sampled every h and held: F(k h) acts from tick k to tick k + 1,
/// so a controller that is told the force knows what acts on the arm exactly.
class Push final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string link;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in the link's frame [m]
    Eigen::Vector3d force;                            ///< F, world axes [N]
    double start_s;
    double duration_s;    ///< from the start of the rise to the end of the fall, ≥ 2 edge_s
    double edge_s = 0.2;  ///< > 0
    Duration period = 1ms;
  };

  explicit Push(const Options& o);

  Output<ContactForce> force;

 private:
  ContactForce At(double t) const;

  const ContactForce full_;
  const double start_, duration_, edge_;
};

/// The generalised force of contact forces, τ_e = Σ Jᵀ F (EC 2): what an observer has to find.
/// F: the forces that join; the configuration: `dynamics`.
class ContactTorque final : public Block {
 public:
  struct Options {
    RobotModel model;
  };

  explicit ContactTorque(const Options& o);

  Input<RobotDynamics> dynamics;
  InputList<ContactForce> contacts;
  Output<JointTorque> torque;

 private:
  JointTorque Sum(const RobotDynamics& d, const Joined<ContactForce>& contacts) const;

  const RobotModel model_;
};

}  // namespace pliant
