#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/systems/signal.h"

namespace pliant {

/// What an arm is told: where to be, what torque to have in its joints, or what current in its
/// motors. Some arms take torques in two ways: with a velocity loop inside, and without one.
enum class ControlMode : std::uint8_t { Position, Torque, Current, TorqueHighVelocity };

inline const std::vector<std::string>& Words(ControlMode) {
  static const std::vector<std::string> words{"position", "torque", "current",
                                              "torque_high_velocity"};
  return words;
}

/// Whether it is one of them: a mode may come from a file, a wire or a fault.
inline bool IsMode(ControlMode mode) { return mode <= ControlMode::TorqueHighVelocity; }

/// A bit for each joint: 1, 2, 4, … for the first, second, third.
using JointBits = std::uint32_t;
static_assert(kMaxJoints <= 32, "JointBits has a bit for each joint");

/// Joints that are in a mode of their own; the others are in the arm's.
struct JointModes {
  using Space = Nothing;
  static constexpr Quantity quantity{"joint modes", ""};

  JointBits position = 0, torque = 0, current = 0, torque_high_velocity = 0;

  ControlMode Of(int joint, ControlMode of_arm) const {
    const JointBits bit = JointBits{1} << joint;
    if (position & bit) return ControlMode::Position;
    if (torque & bit) return ControlMode::Torque;
    if (current & bit) return ControlMode::Current;
    if (torque_high_velocity & bit) return ControlMode::TorqueHighVelocity;
    return of_arm;
  }

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("position", position, "");
    f("torque", torque, "");
    f("current", current, "");
    f("torque_high_velocity", torque_high_velocity, "");
  }
};

/// What an arm says of itself.
struct ArmStatus {
  using Space = Nothing;
  static constexpr Quantity quantity{"arm status", ""};

  ControlMode mode = ControlMode::Torque;  ///< the one that acts
  JointBits switching = 0;                 ///< joints on which it does not act yet
  JointBits saturated = 0;                 ///< joints whose current or torque is cut
  int stopped = 0;                         ///< how many joints are at a hard stop
  JointBits faulted = 0;                   ///< joints whose actuator reports a fault
  bool arm_faulted = false;                ///< the arm as a whole does, or is stopped by a button
  bool connected = true;                   ///< the arm is there and takes commands
  int age = 0;                             ///< ticks since what it measures was new

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("mode", mode, "");
    f("switching", switching, "");
    f("saturated", saturated, "");
    f("stopped", stopped, "");
    f("faulted", faulted, "");
    f("arm_faulted", arm_faulted, "");
    f("connected", connected, "");
    f("age", age, "");
  }
};

}  // namespace pliant
