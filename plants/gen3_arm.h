#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "pliant/plants/arm_status.h"
#include "pliant/plants/gen3_link.h"
#include "pliant/plants/joint_temperature.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/time.h"

namespace pliant {

/// What a Gen3 reports beside its measurements, and what became of the frames.
struct Gen3Report {
  using Space = Nothing;
  static constexpr Quantity quantity{"gen3 report", ""};
  using Banks = std::array<std::uint32_t, kGen3Joints>;

  Banks fault = {}, warning = {};                  ///< of the actuators: bank A; gen3_faults.h
  Banks flags = {};                                ///< of the actuators: StatusFlags
  std::uint32_t base_fault = 0, base_warning = 0;  ///< of the base: bank A
  std::uint32_t arm_state = 0;                     ///< ArmState
  std::int64_t sent = 0, answered = 0;             ///< commands, and those with an answer
  std::int64_t late = 0;                           ///< answers that came a tick or more too late
  std::int64_t out_of_order = 0;                   ///< answers not newer than one before
  std::int64_t not_finite = 0;                     ///< answers with a number that is none
  std::int64_t refused = 0, unreadable = 0;        ///< of the link
  std::int64_t unsent = 0;                         ///< commands the kernel refused

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("fault", fault, "");
    f("warning", warning, "");
    f("flags", flags, "");
    f("base_fault", base_fault, "");
    f("base_warning", base_warning, "");
    f("arm_state", arm_state, "");
    f("sent", sent, "");
    f("answered", answered, "");
    f("late", late, "");
    f("out_of_order", out_of_order, "");
    f("not_finite", not_finite, "");
    f("refused", refused, "");
    f("unreadable", unreadable, "");
    f("unsent", unsent, "");
  }
};

/// What came from a Gen3 until a tick, in SI units and with the model's signs.
struct Gen3Sample {
  using Space = Joints;
  static constexpr Quantity quantity{"gen3 sample", ""};

  JointPosition position;
  JointVelocity velocity;
  JointTorque torque;
  MotorCurrent current;
  JointTemperature temperature;  ///< of the motors
  ArmStatus status;
  Gen3Report report;

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("position", position, "rad");
    f("velocity", velocity, "rad/s");
    f("torque", torque, "N·m");
    f("current", current, "A");
    f("temperature", temperature, "°C");
    f("status", status, "");
    f("report", report, "");
  }
};

/// A Gen3 that is run by frames of ours, one each tick:
///
///   wire                         model
///   position [0°, 360°)    ◀──▶  q, which goes on where a turn ends; limited joints: ±180°
///   torque, measured       ───▶  −τ   the sensor sees what the link does to the actuator
///   torque, commanded      ◀───  τ_d
///   current                ◀──▶  i
///
/// At a tick, Latest takes what has arrived and Command sends the next frame; so the sensors of
/// tick k saw the command of tick k − 1. With the first command the arm is asked for low-level
/// servoing, and as soon as it has it for the mode, one joint after another. Services take some
/// 25 ms each and have a thread of their own; the frames go on meanwhile. A joint that is not in
/// position mode gets its own measured position as position command: if frames fail to come, its
/// firmware notices the growing error and holds (example 108 of the vendor). Where position
/// mode was asked for and not yet answered, the joint is led as if it were in it: it may be. Where
/// a service failed, or an actuator reports a fault, its position command stays where it is.
///
/// Measurements are as old as the command they answer: `age` counts the ticks since its answer
/// could have been there. A joint none of whose numbers changes for long is old too, and a torque
/// that alone stands still is a fault of its sensor. An arm that was in low-level servoing and is
/// not any more, or refuses commands for three ticks in a row, is not connected.
///
/// What is sent is finite and within limits, whatever is commanded: torques, currents and the pace
/// of positions are cut; in the place of a number that is none stays the last one.
///
/// HandBack, or the end of this object, puts all joints into position mode where they are and the
/// arm back to its own servoing. Until a joint is in it, it carries its weight and damps,
///
///   τ = g(q) − D q̇,   i = τ/κ
///
/// One that has left low-level servoing by itself is in position mode already.
///
/// Source: signs and the sequence are those of github.com/Kinovarobotics/Kinova-kortex2_Gen3_G3L
/// (examples 108, 200) and github.com/mathieu-celerier/mc_kortex.
class Gen3Arm {
 public:
  struct Options {
    std::shared_ptr<Gen3Link> link;
    RobotModel model;            ///< of the arm, 7 joints
    MotorCurrent current_limit;  ///< [A], each > 0
    PerJoint torque_per_ampere;  ///< κ [N·m/A], each > 0
    Duration period = 1ms;       ///< of frames
    bool clear_faults = false;   ///< before the start
    /// As many ticks may pass without a change of what a joint measures: sensors have noise. 0:
    /// any.
    int frozen_after = 50;
    /// An arm that waits for each frame, as an emulator in lock-step does: services are done in the
    /// tick that asks for them, and Latest waits for the answer this long, once one failed to come
    /// a hundredth of it. 0: a real arm.
    std::chrono::nanoseconds lock_step{0};
  };

  /// Reads where the arm is. Throws Error if it has another number of joints or is in fault.
  explicit Gen3Arm(Options o);
  ~Gen3Arm();
  Gen3Arm(const Gen3Arm&) = delete;
  Gen3Arm& operator=(const Gen3Arm&) = delete;

  /// Where it is, before the first tick.
  const Gen3Sample& start() const { return sample_; }

  /// In a tick; neither allocate nor throw.
  const Gen3Sample& Latest() noexcept;
  void Command(ControlMode mode, const JointPosition& q_d, const JointTorque& tau_d,
               const MotorCurrent& i_d) noexcept;

  /// Gives the arm back; afterwards Command sends nothing. Throws Error with what did not work,
  /// after all was tried.
  void HandBack();

  /// What services failed, in the arm's words; empty: none did.
  std::string failures() const;

 private:
  using Fields = std::array<std::atomic<std::uint8_t>, kGen3Joints>;
  static constexpr std::uint8_t kNone = 0;  // no Gen3Mode

  void Serve(const std::stop_token& stop);
  bool ServeOne();
  void GiveBack();
  bool Try(const std::string& what, const std::function<void()>& service);
  void Take(const Gen3Feedback& arrived) noexcept;
  void Decode() noexcept;
  void SeeWhatStandsStill(const Gen3Feedback& arrived) noexcept;
  void Send() noexcept;
  void CarryAndHold();
  void Steer(ControlMode mode, const JointPosition& q_d) noexcept;
  bool Moves(int joint) const noexcept;

  const Options o_;
  const JointTorque torque_limit_;
  const PerJoint step_limit_;  // of position commands, in a frame [rad]
  JointBits continuous_ = 0;

  // Of the tick.
  Gen3Feedback feedback_, arrived_;  // the newest, and what has just arrived
  Gen3Sample sample_;
  Gen3Command command_;
  JointPosition reference_;  // the position commands sent last
  struct Sent {
    int id = -1;
    std::int64_t tick = 0;
  };
  std::array<Sent, 64> sent_;               // the last commands
  std::int64_t tick_ = 0, sent_last_ = -1;  // now; of the last command
  std::int64_t newest_ = -1;                // of the command with the newest answer
  std::array<int, kGen3Joints> same_ = {}, same_torque_ = {};  // answers without a change
  int age_ = 0, not_low_level_ = -1;    // ticks; −1: it never was in low-level servoing
  int refusals_ = 0;                    // ticks in a row with nothing but refusals
  bool begun_ = false, prompt_ = true;  // the last answer came in its tick
  RobotDynamics work_;

  // Between the tick and the services.
  std::atomic<std::uint8_t> wanted_{kNone};  // a Gen3Mode, as are those of the joints
  Fields mode_{}, asked_{};                  // as answered; as asked for last, answered or not
  std::atomic<bool> low_level_{false}, failed_{false}, over_{false};
  mutable std::mutex failures_mutex_;
  std::string failures_;
  std::jthread services_;
};

}  // namespace pliant
