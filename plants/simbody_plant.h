#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/simbody_arm.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Poses X_WF of the frames a plant was asked for, in that order.
struct FramePoses {
  using Space = Nothing;
  static constexpr Quantity quantity{"frame poses", ""};

  std::array<Pose, kMaxFrames> pose;
  int size = 0;

  template <class Visitor>
  void Fields(Visitor&& f) {
    for (int i = 0; i < size; ++i)
      f("frame_" + std::to_string(i), pose[static_cast<std::size_t>(i)], "");
  }
};

/// A robot arm moved by joint torques and by forces of its environment:
///
///   q̇ = v,   (M + diag(B)) v̇ + C v + g = τ − d v + Σ Jᵀ F
///
/// `engine` says who computes v̇: Simbody, or the recursive kernel that controllers use; both give
/// the same motion, the kernel in a tenth of the time.
class SimbodyPlant final : public Block {
 public:
  enum class Engine { Simbody, Recursive };

  struct Options {
    RobotModel model;
    JointPosition position;       ///< q at the start [rad]
    JointVelocity velocity = {};  ///< v at the start [rad/s]; empty: at rest
    PerJoint damping = {};        ///< d, viscous friction [N·m·s/rad], each ≥ 0; empty: none
    PerJoint rotor_inertia = {};  ///< B, reflected [kg·m²], each ≥ 0; empty: none
    std::vector<std::string> frames = {};  ///< links whose poses are shown, at most kMaxFrames
    Engine engine = Engine::Simbody;
  };

  explicit SimbodyPlant(const Options& o);

  Input<JointTorque> torque;
  InputList<ContactForce> contacts;  ///< of the environment on links; any number may join
  Output<JointPosition> position;
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;
  Output<FramePoses> poses;

 private:
  struct Workspace {
    SimbodyArm::Workspace simbody;
    RobotDynamics dynamics;
    std::vector<ContactForce> forces =
        std::vector<ContactForce>(16);  // room for as many, unless more join
  };

  JointAcceleration Accelerate(Workspace& w, const JointPosition& q, const JointVelocity& v,
                               const JointTorque& tau, const Joined<ContactForce>& contacts) const;
  void Place(FramePoses& X, Workspace& w, const JointPosition& q, const JointVelocity& v) const;

  const RobotModel model_;
  const std::shared_ptr<const SimbodyArm> simbody_;  // none with the recursive engine
  const PerJoint d_, B_;
  std::vector<int> frames_;
  Continuous<JointPosition> q_;
  Continuous<JointVelocity> v_;
  Scratch<Workspace> work_, pose_work_;
};

}  // namespace pliant
