#pragma once

#include "pliant/controllers/arm_control.h"
#include "pliant/plants/arm_status.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Says what moves an arm, and when that may change, every h:
///
///               ‖r − q‖ < e_track                    another loop: at once
///   position ─────────────────────▶ torque (either loop) ◀──▶ torque
///       ▲                              │ ▲
///       └────────── braking ◀──────────┘ │ torque is wanted again
///         ‖q̇‖ < v_rest  └────────────────┘
///
/// r is the reference of the position; whole turns of joints without limits do not count. q̇ is the
/// measured velocity through a low-pass of `filter_hz`: the noise of sensors alone would be some
/// 0.01 rad/s. While it brakes, and after that, the
/// posture is to be what it was when braking began; before, `start`. A velocity that is no number
/// is none of an arm at rest.
/// Source: Muraccioli et al. 2025 (RSS), the finite-state machine of their demonstration.
class ControlSupervisor final : public Block {
 public:
  struct Settings {
    double tracked_within = 0.05;  ///< e_track [rad]
    double rest_speed = 0.01;      ///< v_rest [rad/s]
    double filter_hz = 5;

    template <class F>
    void Parameters(F&& f) {
      f("tracked_within", tracked_within, "rad", kPositive);
      f("rest_speed", rest_speed, "rad/s", kPositive);
      f("filter_hz", filter_hz, "Hz", kPositive);
    }
  };
  struct Options {
    Joints joints;
    JointPosition start;                            ///< the posture at first [rad]
    ArmControl first = ArmControl::ProposedTorque;  ///< what moves the arm at first
    Settings settings = {};
    JointBits continuous = 0;  ///< joints without limits of the position
    Duration period = 1ms;     ///< h
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    ArmControl control = ArmControl::ProposedTorque;
    bool braking = false;
    JointVelocity velocity;  // filtered
    JointPosition posture;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("control", control, "");
      f("braking", braking, "");
      f("velocity", velocity, "rad/s");
      f("posture", posture, "rad");
    }
  };

  explicit ControlSupervisor(const Options& o);

  Input<ArmControl> wanted;
  Input<JointPosition> reference;  ///< r, as it is in open loop
  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<bool> held;               ///< somebody else has the arm; no if not connected
  Output<ArmControl> control;     ///< what moves the arm
  Output<ControlMode> mode;       ///< of the arm: Position or Current
  Output<bool> braking;           ///< on the way from torque to position, or held in position
  Output<bool> follow;            ///< the reference is the arm itself
  Output<JointPosition> posture;  ///< to hold

 private:
  Memory Next(const Memory& last, ArmControl wanted, const JointPosition& r, const JointPosition& q,
              const JointVelocity& v) const;

  bool IsAt(const JointPosition& r, const JointPosition& q) const;

  const Settings settings_;
  const JointBits continuous_;
  const double alpha_;
  Output<Memory> memory_;
};

}  // namespace pliant
