#pragma once

#include "pliant/diagrams/simulated_arm.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/integral.h"

namespace pliant {

/// The acceleration that follows a sway of 0.1 rad about a rest posture, with a double pole at
/// 20 rad/s:
///
///   a = q̈_d + 40 (q̇_d − v) + 400 (q_d − q)
///   q_d,j(t) = q_rest,j + 0.1 sin(2 t + φ_j),   φ from 0 to 3 rad in equal steps
///
JointAcceleration SwayAcceleration(double t, const JointPosition& rest, const RobotDynamics& d);

/// Sways by computed torque: τ = (M + diag(B)) a + C v + g.
class SwayLaw final : public Block {
 public:
  struct Options {
    Joints joints;
    JointPosition rest;
    Duration period = {};  ///< of samples that are held; 0: continuous
  };

  explicit SwayLaw(const Options& o);

  Input<RobotDynamics> dynamics;  ///< with B
  Output<JointAcceleration> acceleration;
  Output<JointTorque> torque;

 private:
  JointAcceleration Want(double t, const RobotDynamics& d) const {
    return SwayAcceleration(t, rest_, d);
  }

  const JointPosition rest_;
};

/// A simulated arm that sways about the posture it starts at, at the arm's period:
///
///   arm ─▶ dynamics ─▶ law ─▶ torque mode, or low level ─▶ current mode ─▶ arm
///
/// Arms in current mode get the torque loop of stations.h.
struct SwayLoop {
  struct Options {
    SimulatedArm::Options arm;
    bool account = false;  ///< of energy: `work` and `heat` are integrated with the arm
  };

  explicit SwayLoop(const Options& o);

  SimulatedArm* arm;
  Integral<double>* work = nullptr;  ///< of the motors [J]
  Integral<double>* heat = nullptr;  ///< what is dissipated [J]
  Diagram diagram;

 private:
  static Diagram Make(const Options& o, SwayLoop& parts);
};

/// The same law on the bare plant, without sampling: a smooth system.
struct SmoothSwayLoop {
  explicit SmoothSwayLoop(const SimbodyPlant::Options& o);

  SimbodyPlant* arm;
  Diagram diagram;

 private:
  static Diagram Make(const SimbodyPlant::Options& o, SmoothSwayLoop& parts);
};

}  // namespace pliant
