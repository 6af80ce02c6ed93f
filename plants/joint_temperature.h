#pragma once

#include "pliant/systems/signal.h"

namespace pliant {

/// How hot the motors are, as far as an arm says it.
struct JointTemperature : JointSignal<JointTemperature> {
  using Signal::Signal;
  static constexpr Quantity quantity{"joint temperature", "°C"};
};

}  // namespace pliant
