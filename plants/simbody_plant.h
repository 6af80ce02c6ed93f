#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/simbody_arm.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A robot arm moved by joint torques and by forces of its environment:
///
///   q̇ = v,   (M + diag(B)) v̇ + C v + g = τ − d v + Σ τ_l + Σ Jᵀ F
///
/// `engine` says who computes v̇: Simbody, or the recursive kernel that controllers use; both give
/// the same motion, the kernel in a tenth of the time.
class SimbodyPlant final : public Block {
 public:
  enum class Engine { Simbody, Recursive };
  friend const std::vector<std::string>& Words(Engine) {
    static const std::vector<std::string> words{"simbody", "recursive"};
    return words;
  }

  struct Options {
    RobotModel model;
    JointPosition position;       ///< q at the start [rad]
    JointVelocity velocity = {};  ///< v at the start [rad/s]; empty: at rest
    PerJoint damping = {};        ///< d, viscous friction [N·m·s/rad], each ≥ 0; empty: none
    PerJoint rotor_inertia = {};  ///< B, reflected [kg·m²], each ≥ 0; empty: none
    std::vector<std::string> frames = {};  ///< links shown by `motion`, at most kMaxFrames
    Engine engine = Engine::Simbody;
  };

  explicit SimbodyPlant(const Options& o);

  Input<JointTorque> torque;         ///< τ, of the actuators on the links
  InputList<JointTorque> loads;      ///< τ_l, such as those of joint stops; any number may join
  InputList<ContactForce> contacts;  ///< F, of the environment on links; any number may join
  Output<JointPosition> position;
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;
  Output<RobotDynamics> motion;  ///< what an environment asks for; without B
  Output<double> energy;         ///< ½ vᵀ (M + diag(B)) v + U [J]
  Output<double> dissipation;    ///< vᵀ diag(d) v [W]

 private:
  struct Workspace {
    SimbodyArm::Workspace simbody;
    std::vector<ContactForce> forces =
        std::vector<ContactForce>(16);  // room for as many, unless more join
  };

  JointAcceleration BySimbody(Workspace& w, const JointPosition& q, const JointVelocity& v,
                              const JointTorque& tau, const Joined<JointTorque>& loads,
                              const Joined<ContactForce>& contacts) const;
  JointAcceleration Recursively(const RobotDynamics& d, const JointTorque& tau,
                                const Joined<JointTorque>& loads,
                                const Joined<ContactForce>& contacts) const;
  void Move(RobotDynamics& d, const JointPosition& q, const JointVelocity& v) const;
  double Energy(const RobotDynamics& d) const;
  double Dissipate(const JointVelocity& v) const;

  const RobotModel model_;
  const std::shared_ptr<const SimbodyArm> simbody_;  // none with the recursive engine
  const PerJoint d_, B_;
  Continuous<JointPosition> q_;
  Continuous<JointVelocity> v_;
  Scratch<Workspace> work_;
};

}  // namespace pliant
