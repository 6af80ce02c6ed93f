#pragma once

#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

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
    static constexpr const char* kTag = "Push";

    RobotModel model;
    std::string link;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();                ///< in the link's frame [m]
    Eigen::Vector3d force = Eigen::Vector3d::Constant(kToBeGiven);  ///< F, world axes [N]
    double start_s = kToBeGiven;
    double duration_s = kToBeGiven;  ///< from the start of the rise to the end of the fall
    double edge_s = 0.2;             ///< of the rise and of the fall, each at most half of it
    Duration period = 1ms;

    template <class F>
    void Parameters(F&& f) {
      f("link", link);
      f("point", point, "m");
      f("force", force, "N");
      f("start_s", start_s, "s", Between(-1e6, 1e6));
      f("duration_s", duration_s, "s", Between(1e-9, 1e6));
      f("edge_s", edge_s, "s", kPositive);
    }
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
