#pragma once

#include <string>

#include "pliant/controllers/safety_supervisor.h"

namespace pliant {

/// What a supervisor saw, for who stands at the arm:
///
///   torque_jump at joint 2: 40 N·m, allowed 38 N·m in a tick
std::string SafetyText(SafetyCause cause, int joint, double value, double limit);

/// What to look at, and do, after it; empty where nothing is known.
std::string SafetyHint(SafetyCause cause);

}  // namespace pliant
