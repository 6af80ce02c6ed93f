#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/plants/gen3_link.h"

namespace pliant {

/// The names of the bits of a bank A of faults or warnings, in the protocol's words, such as
/// FOLLOWING_ERROR; "bit 31" where it has none.
std::vector<std::string> ActuatorFaultNames(std::uint32_t bank_a);
std::vector<std::string> BaseFaultNames(std::uint32_t bank_a);

/// Such as ARMSTATE_SERVOING_READY; the number if the protocol has no name for it.
std::string ArmStateName(std::uint32_t state);
std::string Gen3ServoingName(Gen3Servoing servoing);
std::string Gen3ModeName(Gen3Mode mode);

}  // namespace pliant
