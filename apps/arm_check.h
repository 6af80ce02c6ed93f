#pragma once

#include "pliant/apps/doctor_checks.h"
#include "pliant/plants/gen3_address.h"

namespace pliant {

/// Connects by TCP, opens sessions, asks for state and servoing and reads feedback each millisecond
/// for a third of a second; commands nothing. Never throws for what the arm does.
ArmFacts TryArm(const Gen3Address& address);

}  // namespace pliant
