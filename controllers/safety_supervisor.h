#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/plants/arm_status.h"
#include "pliant/plants/joint_temperature.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"
#include "pliant/systems/tick_timing.h"

namespace pliant {

/// Who has the arm.
enum class SafetyState : std::uint8_t {
  Engaging,  ///< damped gravity compensation, until the arm is in the mode of its controller
  Running,   ///< the controller
  Damped,    ///< damped gravity compensation
  Holding,   ///< the arm's own position control, at rest
  Stopped,   ///< the same, and the run is to end
};

inline const std::vector<std::string>& Words(SafetyState) {
  static const std::vector<std::string> words{"engaging", "running", "damped", "holding",
                                              "stopped"};
  return words;
}

/// Why it is not the controller.
enum class SafetyCause : std::uint8_t {
  None,
  UserStop,
  NotConnected,   ///< the arm takes no commands
  ArmFault,       ///< the arm as a whole reports one, or its emergency stop
  JointFault,     ///< an actuator does
  StaleFeedback,  ///< older than allowed
  NotFinite,      ///< a measurement is no number
  PositionLimit,  ///< of a joint, with margin
  PositionJump,   ///< measured, from one measurement to the next
  VelocityLimit,
  TorqueLimit,
  TorqueJump,  ///< measured, from one tick to the next
  Tracking,    ///< of a position command
  Temperature,
  CommandNotFinite,  ///< of the controller, or a mode that is none
  CommandJump,       ///< from one tick to the next
  Divergence,        ///< of the estimated external torque
  Overruns,
  Mode,  ///< the arm does not come into the mode it is asked for
};

inline const std::vector<std::string>& Words(SafetyCause) {
  static const std::vector<std::string> words{
      "none",           "user_stop",   "not_connected",  "arm_fault",     "joint_fault",
      "stale_feedback", "not_finite",  "position_limit", "position_jump", "velocity_limit",
      "torque_limit",   "torque_jump", "tracking",       "temperature",   "command_not_finite",
      "command_jump",   "divergence",  "overruns",       "mode"};
  return words;
}

/// What somebody who watches the arm wants.
struct OperatorWord {
  using Space = Nothing;
  static constexpr Quantity quantity{"operator word", ""};

  bool stop = false;
  std::uint32_t acknowledged = 0;  ///< how often a fault was

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("stop", stop, "");
    f("acknowledged", acknowledged, "");
  }
};

/// What the supervisor says at every tick.
struct SafetyReport {
  using Space = Nothing;
  static constexpr Quantity quantity{"safety report", ""};

  SafetyState state = SafetyState::Engaging;
  SafetyCause cause = SafetyCause::None;  ///< of the first fault since the last acknowledgement
  int joint = -1;                         ///< that it was seen at; −1: the arm as a whole
  double value = 0, limit = 0;            ///< what was found there, and what was allowed
  SafetyCause now = SafetyCause::None;    ///< a fault that is there at this tick
  double since = 0;                       ///< in this state [s]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("state", state, "");
    f("cause", cause, "");
    f("joint", joint, "");
    f("value", value, "");
    f("limit", limit, "");
    f("now", now, "");
    f("since", since, "s");
  }
};

/// Stands between a controller and its arm, every h, and takes the arm away from a controller that
/// must not have it:
///
///   Engaging ──▶ Running ──▶ Damped ──▶ Holding ──▶ Stopped
///       ▲           │  fault   │ ▲  at rest  ▲  after t_hold
///       └───────────┴──────────┴─┼───────────┘
///            acknowledged        └─ position control, feedback that is not to be trusted or
///                                   the arm's own fault: at once to Holding
///
///   Damped    τ = g(q) − D q̇, cut at the limits;  i = τ/κ
///   Holding   position control; r begins at q, or of position control where r was but no further
///             from q than `tracking`, and comes to rest with the deceleration a
///
/// Engaging and, after it, T seconds of blending lead from the damped law to the controller's
/// torques or currents; in position control from where the arm is held to q_d, which must be within
/// `tracking` of it. D_j is no larger than M_jj/(10 h), so that it does
/// not shake joints without rotors. Damped lasts until all joints are slower than v_rest for 0.2 s,
/// t_damped at most. A fault stays until it is acknowledged while it is no longer there, in Damped
/// or Holding; the first cause is reported. A stop that the user asked for cannot be acknowledged.
///
/// Whatever comes in, what goes out is finite and within ± the torque and current limits, and its
/// mode is one. Where a measurement is no number the last one that was is used.
class SafetySupervisor final : public Block {
 public:
  /// The defaults are ours, tried on the emulated Gen3.
  struct Settings {
    int stale_after = 5;            ///< ticks without new measurements, ≥ 1
    double position_margin = 0.01;  ///< inside the joints' limits [rad]
    double position_jump =
        0.02;  ///< measured, from one to the next, beside v_max a tick lost [rad]
    double velocity_limit = 0.95;  ///< of |q̇_j|, as a share of the joint's limit
    double torque_limit = 0.95;    ///< of |τ_j|, as a share of the joint's limit
    double torque_jump = 0.4;      ///< of |τ_j| in a tick, as a share of the joint's limit
    double command_jump = 0.5;     ///< of |τ_d,j| or |i_d,j| in a tick, as a share of its limit
    double tracking = 0.07;        ///< ‖q_d − q‖∞ in position control [rad]
    double divergence = 1;         ///< of |τ̂_e,j|, as a share of the joint's torque limit
    double temperature = 75;       ///< of a motor [°C]
    int most_missed = 20;          ///< ticks at once; as many a second are forgiven
    double engage_s = 3;           ///< until the mode asked for must be there
    double blend_s = 0.5;          ///< T
    PerJoint damping = {};         ///< D [N·m·s/rad]; empty: 8 % of the torque limits a rad/s
    double rest_speed = 0.05;      ///< v_rest [rad/s]
    double damped_s = 3;           ///< t_damped
    double hold_s = 5;             ///< t_hold
    double deceleration = 5;       ///< a [rad/s²]

    template <class F>
    void Parameters(F&& f) {
      f("stale_after", stale_after, "", Between(1, 1e6));
      f("position_margin", position_margin, "rad", kNotNegative);
      f("position_jump", position_jump, "rad", kPositive);
      f("velocity_limit", velocity_limit, "", kPositive);
      f("torque_limit", torque_limit, "", kPositive);
      f("torque_jump", torque_jump, "", kPositive);
      f("command_jump", command_jump, "", kPositive);
      f("tracking", tracking, "rad", kPositive);
      f("divergence", divergence, "", kPositive);
      f("temperature", temperature, "°C", kPositive);
      f("most_missed", most_missed, "", Between(1, 1e6));
      f("engage_s", engage_s, "s", kPositive);
      f("blend_s", blend_s, "s", kPositive);
      f("damping", damping, "N·m·s/rad", kNotNegative);
      f("rest_speed", rest_speed, "rad/s", kPositive);
      f("damped_s", damped_s, "s", kPositive);
      f("hold_s", hold_s, "s", kPositive);
      f("deceleration", deceleration, "rad/s²", kPositive);
    }
  };
  struct Options {
    RobotModel model;            ///< of the controller: limits and weight
    JointPosition position;      ///< at the start [rad]
    PerJoint torque_per_ampere;  ///< κ [N·m/A], each > 0
    MotorCurrent current_limit;  ///< [A], each > 0
    Settings settings = {};
    Duration period = 1ms;  ///< h
  };

  explicit SafetySupervisor(const Options& o);

  Input<ControlMode> mode;                ///< these four of the controller
  Input<JointPosition> position_command;  ///< the start if not connected
  Input<JointTorque> torque_command;
  Input<MotorCurrent> current_command;
  Input<JointPosition> measured_position;  ///< these of the arm
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Input<JointTemperature> temperature;  ///< 0 if not connected
  Input<ArmStatus> status;
  Input<JointTorque> external_torque;  ///< estimated; 0 if not connected
  Input<TickTiming> timing;            ///< none if not connected
  Input<OperatorWord> word;            ///< none if not connected

  Output<ControlMode> arm_mode;  ///< these four for the arm
  Output<JointPosition> arm_position;
  Output<JointTorque> arm_torque;
  Output<MotorCurrent> arm_current;
  Output<SafetyReport> report;
  Output<bool> has_arm;  ///< Damped, Holding or Stopped: the controller has no say

 private:
  /// What a tick sees, in one value.
  struct Seen {
    ControlMode mode = ControlMode::Position;
    JointPosition q_d, q;
    JointTorque tau_d, tau, estimate;
    MotorCurrent i_d;
    JointVelocity v;
    JointTemperature temperature;
    ArmStatus status;
    TickTiming timing;
    OperatorWord word;
  };
  struct Finding {
    SafetyCause cause = SafetyCause::None;
    int joint = -1;
    double value = 0, limit = 0;
  };
  /// What it remembers from one tick to the next, and what goes to the arm.
  struct Memory {
    SafetyReport report;
    ControlMode mode = ControlMode::Position;  // these four went to the arm
    JointPosition position;
    JointTorque torque;
    MotorCurrent current;
    ControlMode asked = ControlMode::Position;  // by the controller, when it last had one
    JointPosition q;                            // the last numbers measured
    JointVelocity v;
    JointTorque tau;
    JointTorque tau_d;  // the controller's last commands
    MotorCurrent i_d;
    JointVelocity rate;              // of the position command
    JointPosition held;              // where Engaging holds the arm in position control
    double share = 0;                // of the controller in what goes to the arm
    double rest = 0, switching = 0;  // [s] at rest; not in the mode asked for
    double missed = 0;               // ticks; `most_missed` a second are forgiven
    int age = 0;                     // of the last measurements
    std::int64_t counted = 0;
    std::uint32_t acknowledged = 0;
    bool started = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("report", report, "");
      f("mode", mode, "");
      f("position", position, "rad");
      f("torque", torque, "N·m");
      f("current", current, "A");
      f("asked", asked, "");
      f("q", q, "rad");
      f("v", v, "rad/s");
      f("tau", tau, "N·m");
      f("tau_d", tau_d, "N·m");
      f("i_d", i_d, "A");
      f("rate", rate, "rad/s");
      f("held", held, "rad");
      f("share", share, "");
      f("rest", rest, "s");
      f("switching", switching, "s");
      f("missed", missed, "");
      f("age", age, "");
      f("counted", counted, "");
      f("acknowledged", acknowledged, "");
      f("started", started, "");
    }
  };

  static Memory Before(const Options& o);
  Memory Next(const Memory& last, RobotDynamics& work, const Seen& seen) const;
  Finding Look(const Memory& m, const Seen& seen) const;
  Finding LookAtArm(const Seen& seen) const;
  Finding LookAtMeasurements(const Memory& m, const Seen& seen) const;
  Finding LookAtCommands(const Memory& m, const Seen& seen) const;
  void Count(Memory& m, const Seen& seen) const;
  void Move(Memory& m, const Seen& seen, const Finding& found) const;
  static void Enter(Memory& m, SafetyState state);
  void Hold(Memory& m) const;
  void Command(Memory& m, const Seen& seen, RobotDynamics& work) const;
  bool IsThere(const Memory& m, const Seen& seen) const;
  bool IsReady(const Memory& m, const Seen& seen) const;
  static void Engage(Memory& m);

  const Options o_;
  const double h_;
  const JointPosition lower_, upper_;
  const PerJoint v_max_, tau_max_, i_max_, D_;
  Output<Seen> seen_;
  Output<Memory> memory_;
  Scratch<RobotDynamics> work_;
};

}  // namespace pliant
