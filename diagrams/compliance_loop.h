#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/joint_damper.h"
#include "pliant/controllers/low_level_torque.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/diagrams/simulated_arm.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/push.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/logger.h"

namespace pliant {

/// Where the controller has τ̂_e from.
enum class TorqueEstimate { True, Observer, Zero };

/// An arm that holds a pose of its tool while it is pushed, with as much compliance in its pose and
/// its posture as asked for.
///
///   push… ──────────────▶ arm ─▶ dynamics ─▶ pose task, posture task ─▶ qp ─▶ low level ─▶ arm
///   push… ─▶ true torque ─▶ │        │                ▲                  ▲
///                           └─▶ observer ─▶ estimate ─┴─ external acceleration, dampers
///
/// The rotors are part of what the controller moves and gives its compliance to; the observer,
/// which is driven by torque sensors behind the gears, sees the links alone.
struct ComplianceLoop {
  struct Options {
    RobotModel model;           ///< the controller's
    std::string tool;           ///< link whose pose is held
    SimulatedArm::Options arm;  ///< starts at the posture to hold
    /// Makes currents of the torques; without, the arm's torque mode does what it is told.
    std::optional<LowLevelTorque::Options> low_level = {};

    double pose_stiffness = 400, pose_damping = 40, pose_weight = 1e4;
    double posture_stiffness = 0, posture_damping = 5, posture_weight = 1;
    double pose_compliance = 0, posture_compliance = 0;  ///< γ in Γ = γ I

    TorqueEstimate estimate = TorqueEstimate::Observer;
    double observer_gain = 50;  ///< K_I [1/s]

    JointDamper::Options damper;
    std::vector<Push::Options> pushes = {};  ///< sampled at the arm's period
    std::size_t log_rows = 0;                ///< room for this many ticks in the log
  };

  explicit ComplianceLoop(const Options& o);

  SimulatedArm* arm;
  ModelDynamics *dynamics, *link_dynamics;
  ContactTorque* true_torque;
  MomentumObserver* observer;
  FrameTask* pose;
  PostureTask* posture;
  JointDamper* damper;
  ComplianceQp* qp;
  LowLevelTorque* low_level = nullptr;  ///< none with ideal actuators
  std::vector<Push*> pushes;
  Logger* logger;  ///< pushes, measurements, torques, pose error and report of every tick
  Diagram diagram;

 private:
  static Diagram Make(const Options& o, ComplianceLoop& parts);
};

}  // namespace pliant
