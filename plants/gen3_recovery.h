#pragma once

#include <string>
#include <vector>

#include "pliant/plants/gen3_address.h"

namespace pliant {

/// Brings back an arm that a program has left in low-level servoing: clears its faults if asked to,
/// sets every actuator to position mode and the arm to single-level servoing, where it holds
/// itself.
///
/// What was found and done, a line each. An actuator that refuses its mode is a line too; Error is
/// thrown if the arm cannot be reached, or is not in single-level servoing in the end. Needs TCP
/// only; faults are told if UDP answers.
std::vector<std::string> Recover(const Gen3Address& address, bool clear_faults);

}  // namespace pliant
