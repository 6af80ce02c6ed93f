#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/systems/signal.h"

namespace pliant {

/// What moves an arm: its own position control, or torques through one of two loops.
enum class ArmControl : std::uint8_t { Position, KinovaTorque, ProposedTorque };

inline const std::vector<std::string>& Words(ArmControl) {
  static const std::vector<std::string> words{"position", "kinova_torque", "proposed_torque"};
  return words;
}

}  // namespace pliant
