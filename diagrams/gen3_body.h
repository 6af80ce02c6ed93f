#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pliant/diagrams/fault_order.h"
#include "pliant/diagrams/stations.h"
#include "pliant/plants/gen3_link.h"
#include "pliant/systems/simulator.h"

namespace pliant {

/// What is behind the base of an emulated Gen3: the simulated arm, its actuators with a mode and
/// faults of their own, and who moves it. It is stepped by 1 ms, in the units of the wire:
///
///   position = 180/π q mod 360°,   velocity = 180/π v,   torque = −τ,   current = i
///
/// A command acts from the step after it on; the feedback is what the sensors said at the last one.
///
/// Who moves it. Single-level: it stays where it is. Low-level: each joint follows the commands in
/// its mode, which is position at first. A command acts on a joint if it is newer than the last
/// one, (id − last) mod 2¹⁶ < 2¹⁵, and all its numbers are finite. Ids are new with each start of
/// low-level servoing.
///
/// A fault stops low-level servoing: all joints hold in position mode where they are, the arm's
/// state is IN_FAULT, and nothing but ClearFaults leads out of it. The first fault is told, those
/// that follow from it are not.
///
///   FOLLOWING_ERROR     |command − q| > 5° in low-level servoing, in every mode; warning 3°
///   MAXIMUM_VELOCITY    |v| > 120 and 200 °/s, large and small joints; warning 100 and 180 °/s
///   MAXIMUM_TORQUE      |τ| > 104.5 and 51.3 N·m; warning 56.7 and 29.4 N·m
///   JOINT_LIMIT_HIGH    q beyond the model's limit; once cleared, 1° further or anew from within
///   CYCLIC_DATA_JITTER  of the base: no command for more than `patience_ticks`, after the first
///
/// Documented: the thresholds (Gen3 User Guide, p. 85; joint limits apart), that a following error
/// ends in a position hold, the names. Observed by others: units, signs, the actuators' ids. Ours,
/// as the firmware is not public: everything else, such as that all joints stop with one, how long
/// missing commands are borne, what becomes of commands that are not finite, and the motors'
/// temperature, T' = (T_a + c i² − T)/θ with T_a = 25 °C, c = 0.5 °C/A² and θ = 600 s. The base
/// says nothing of its tool and its accelerometer: they read 0.
class Gen3Body {
 public:
  struct Options {
    std::optional<RobotModel> model = {};  ///< none: models/gen3/gen3_7dof.urdf
    /// Without a position: home, (0, 15, 180, −130, 0, 55, 90)°.
    StationOptions station = {.engine = SimbodyPlant::Engine::Recursive};
    int patience_ticks = 20;              ///< > 0
    std::vector<FaultOrder> faults = {};  ///< those of Kinds act
    /// Sees each step, in the thread that makes it.
    std::function<void(const Gen3Body&)> watch = {};
  };

  explicit Gen3Body(const Options& o);
  Gen3Body(const Gen3Body&) = delete;
  Gen3Body& operator=(const Gen3Body&) = delete;

  /// The faults that can be ordered of it. Sensors alone are wrong in the eyes of who reads the
  /// feedback and of the checks above: the joint's own loop goes on as if they were right.
  ///
  ///   actuator_fault:J       MOTOR_DRIVER_FAULT
  ///   following_error:J      the position is 6° further from the command than it is
  ///   overspeed:J            the velocity reads a tenth above what is borne
  ///   torque_sensor_dead:J   the torque reads 0
  ///   torque_jump:J          the torque reads 30 N·m more
  ///   encoder_jump:J         the position reads 2° more
  ///   frozen                 all numbers stay, ids go on
  ///   nan                    position, velocity, torque and current are not finite
  ///   emergency_stop         EMERGENCY_STOP_ACTIVATED
  static std::vector<FaultOrder::Kind> Kinds();

  /// One millisecond. One that is late does not count against the patience with commands: they may
  /// be there. Throws Error if the simulation cannot go on.
  void Step(bool late = false);
  std::int64_t ticks() const { return ticks_; }

  /// Since low-level servoing first began; none before [s].
  std::optional<double> servoed() const;
  bool Shows(const std::string& kind) const;

  const Gen3Feedback& feedback() const { return feedback_; }
  Gen3Servoing servoing() const { return servoing_; }
  bool in_fault() const;
  bool emergency_stopped() const;
  Gen3Mode mode(int joint) const { return modes_[static_cast<std::size_t>(joint)]; }

  void EnterLowLevel();  ///< if there is no fault
  void LeaveLowLevel();
  void SetMode(int joint, Gen3Mode mode);  ///< in low-level servoing
  void ClearFaults();
  void ClearFaults(int joint);  ///< those of its actuator
  void EmergencyStop();

  using Ids = std::array<std::uint32_t, kGen3Joints>;  ///< of commands: their low 16 bits count
  void Command(const Gen3Command& command, const Ids& ids, std::uint32_t frame_id,
               std::uint32_t jitter_us);

  /// q and v of the plant, and what the joints that are not in position mode are told.
  const JointPosition& position() const { return sim_->Get(arm_->position); }
  const JointVelocity& velocity() const { return sim_->Get(arm_->velocity); }
  const JointTorque& commanded_torque() const { return torque_; }
  const MotorCurrent& commanded_current() const { return current_; }

 private:
  struct Limits {
    double velocity, velocity_warning;  // [°/s]
    double torque, torque_warning;      // [N·m]
  };
  static const Limits& LimitsOf(std::size_t joint);

  void Hold();
  void Drive();
  void Measure();
  void Check();
  void Fail(std::size_t joint, std::uint32_t bit);
  void FailBase(std::uint32_t bit);
  void Tell();
  bool ShowsOf(const char* kind, std::size_t joint) const;

  const Options o_;
  SimulatedArm* arm_ = nullptr;
  std::optional<Diagram> diagram_;
  mutable std::optional<Simulator> sim_;  // Get computes what is not yet
  JointPosition lower_, upper_;           // where a limit trips [rad]
  JointPosition model_lower_, model_upper_;

  std::int64_t ticks_ = 0, began_ = -1;
  std::int64_t silent_ = -1;  // ticks since the last command; −1: none yet
  Gen3Servoing servoing_ = Gen3Servoing::SingleLevel;
  std::array<Gen3Mode, kGen3Joints> modes_;
  std::array<std::optional<std::uint16_t>, kGen3Joints> last_id_;
  JointPosition target_;
  JointTorque torque_;
  MotorCurrent current_;

  JointPosition q_;       // as the joint's own loop reads it
  JointPosition q_read_;  // as everybody else does
  JointVelocity v_read_;
  JointTorque tau_read_;
  std::array<double, kGen3Joints> heat_ = {};  // of the motors [°C]
  Gen3Feedback feedback_;
};

}  // namespace pliant
