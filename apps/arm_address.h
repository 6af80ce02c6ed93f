#pragma once

#include <string>

#include "pliant/apps/doctor_checks.h"

namespace pliant {

/// Where an arm listens.
struct ArmAddress {
  std::string host;
  int port = 10000;  ///< Kinova's for everything but the 1 kHz exchange

  /// Of "192.168.1.10", "arm.local:10000", "[fe80::1]:10000". Throws Error if it is none.
  static ArmAddress Of(const std::string& text);

  std::string text() const;
};

/// Whether something accepts a TCP connection there within two seconds; says nothing to it.
ArmFacts TryArm(const ArmAddress& address);

}  // namespace pliant
