#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/systems/signal.h"

namespace pliant {

/// What an arm is told: where to be, what torque to have in its joints, or what current in its
/// motors.
enum class ControlMode { Position, Torque, Current };

inline const std::vector<std::string>& Words(ControlMode) {
  static const std::vector<std::string> words{"position", "torque", "current"};
  return words;
}

/// A bit for each joint: 1, 2, 4, … for the first, second, third.
using JointBits = std::uint32_t;
static_assert(kMaxJoints <= 32, "JointBits has a bit for each joint");

/// What an arm says of itself.
struct ArmStatus {
  using Space = Nothing;
  static constexpr Quantity quantity{"arm status", ""};

  ControlMode mode = ControlMode::Torque;  ///< the one that acts
  JointBits saturated = 0;                 ///< joints whose current or torque is cut
  int stopped = 0;                         ///< how many joints are at a hard stop

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("mode", mode, "");
    f("saturated", saturated, "");
    f("stopped", stopped, "");
  }
};

}  // namespace pliant
