#pragma once

#include <memory>
#include <span>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// A robot arm in Simbody 3.7 (Sherman, Seth & Delp, Procedia IUTAM 2, 2011): the physics of the
/// plant.
///
///   (M + diag(B)) v̇ + C v + g = τ + τ_e
///
/// The arm is const and may be shared by threads; each thread, and each context, has its own
/// Workspace. Joints, links, frames and signs are those of the RobotModel.
class SimbodyArm {
 public:
  explicit SimbodyArm(const RobotModel& model);

  /// Simbody's state and caches: a place to compute in. Results never depend on what it held
  /// before. A copy is a fresh one; a fresh one costs about 0.1 ms at its first use.
  class Workspace {
   public:
    Workspace();
    Workspace(const Workspace&);
    Workspace& operator=(const Workspace&);
    Workspace(Workspace&&) noexcept;
    Workspace& operator=(Workspace&&) noexcept;
    ~Workspace();

   private:
    friend class SimbodyArm;
    struct State;
    std::unique_ptr<State> state_;
  };

  const RobotModel& model() const { return model_; }

  /// v̇ at (q, v) under the torques τ, the forces of the environment on the links and gravity. B is
  /// the reflected rotor inertia of each joint [kg·m²]; empty: none. Not a number where Simbody
  /// finds no acceleration.
  JointAcceleration ForwardDynamics(const JointPosition& q, const JointVelocity& v,
                                    const JointTorque& tau, std::span<const ContactForce> forces,
                                    const PerJoint& rotor_inertia, Workspace& workspace) const;

  /// All that `pliant::ComputeDynamics` computes, by Simbody's own algorithms.
  void ComputeDynamics(const JointPosition& q, const JointVelocity& v, RobotDynamics& d,
                       Workspace& workspace) const;

 private:
  struct System;
  Workspace::State& Prepare(const JointPosition& q, const JointVelocity& v, Workspace& w) const;

  RobotModel model_;
  std::shared_ptr<const System> system_;
};

}  // namespace pliant
