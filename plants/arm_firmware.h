#pragma once

#include <array>
#include <optional>

#include "pliant/plants/arm_status.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// What an arm does by itself with its commands, every h:
///
///   Position   τ_m = k_p (r − q) + k_d (ṙ − ω) + ∫ k_i (r − q) dt + g
///   Torque     τ_m = f τ_d + g + k H(z) (τ_d + g − τ) − d ω
///   Current    τ_m = κ i_d
///   i = τ_m/κ, with ∫ and τ_m within ± τ_max
///
/// TorqueHighVelocity is Torque without d. Joints may be in a mode of their own.
///
/// r goes in a straight line from one position command q_d to the next, within `command_period`. ω
/// is the velocity of the rotors, κ the torque per ampere behind the gear. g is the gravity torque
/// of `compensated`, for arms that carry their own weight; without, 0. H is KinovaLag; what the
/// vendor adds to it is not published, so f and k are parameters. On a change of mode H starts at
/// rest, and the integral takes over what of the torque that was there the other terms do not make.
///
/// i is held; the motors' drives take it over at the same tick.
class ArmFirmware final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint torque_per_ampere;     ///< κ [N·m/A], each > 0
    PerJoint position_stiffness;    ///< k_p [N·m/rad], each ≥ 0
    PerJoint position_damping;      ///< k_d [N·m·s/rad], each ≥ 0
    PerJoint position_integral;     ///< k_i [N·m/(rad·s)], each ≥ 0
    double torque_feedforward = 1;  ///< f
    double torque_feedback = 0;     ///< k
    double torque_damping = 0;      ///< d [N·m·s/rad]
    JointTorque torque_limit;       ///< of ∫ and τ_m [N·m], each > 0
    std::optional<RobotModel> compensated = {};
    JointTorque load = {};                   ///< what the motors carry before the first tick [N·m]
    ControlMode mode = ControlMode::Torque;  ///< where `mode` is not connected
    Duration period = 1ms;                   ///< h
    Duration command_period = {};            ///< of position commands, a multiple of h; 0: h
  };

  explicit ArmFirmware(const Options& o);

  Input<ControlMode> mode;
  Input<JointModes> joint_modes;
  Input<JointPosition> position_command;  ///< q_d
  Input<JointTorque> torque_command;      ///< τ_d
  Input<MotorCurrent> current_command;    ///< i_d
  Input<JointPosition> position;          ///< q, measured
  Input<JointVelocity> motor_velocity;    ///< ω; motor encoders are a gear ratio finer than noise
  Input<JointTorque> torque;              ///< τ, measured
  Output<MotorCurrent> current;           ///< i
  Output<ControlMode> active;             ///< the mode that made i
  Output<JointBits> cut;                  ///< joints whose τ_m is at its limit

 private:
  struct State {
    ControlMode mode = ControlMode::Torque;               ///< of the arm
    std::array<ControlMode, kMaxJoints> joint_mode = {};  ///< of each joint
    JointTorque torque, integral;                         ///< τ_m, ∫
    JointPosition position_command;                       ///< q_d of the tick before
    JointPosition reference;                              ///< r
    PerJoint step;                                        ///< of r in a tick [rad]
    int steps = 0;                                        ///< that are left until q_d
    PerJoint e1, e2, y1, y2;                              ///< H's memory
    JointBits cut = 0;
    bool fresh = true;  ///< nothing was commanded yet

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("mode", mode, "");
      f("joint_mode", joint_mode, "");
      f("torque", torque, "N·m");
      f("integral", integral, "N·m");
      f("position_command", position_command, "rad");
      f("reference", reference, "rad");
      f("step", step, "rad");
      f("steps", steps, "");
      f("e1", e1, "N·m");
      f("e2", e2, "N·m");
      f("y1", y1, "N·m");
      f("y2", y2, "N·m");
      f("cut", cut, "");
      f("fresh", fresh, "");
    }
  };

  static State AtRest(const Options& o);
  State Next(const State& last, RobotDynamics& work, ControlMode asked, const JointModes& own,
             const JointPosition& q_d, const JointTorque& tau_d, const MotorCurrent& i_d,
             const JointPosition& q, const JointVelocity& omega, const JointTorque& tau) const;
  void Lead(State& next, const JointPosition& q_d) const;

  MotorCurrent Current(const State& s) const {
    return s.torque.cwiseQuotient(o_.torque_per_ampere);
  }

  const Options o_;
  const int steps_;  // of h in the period of commands
  Output<State> state_;
  Scratch<RobotDynamics> work_;
};

}  // namespace pliant
