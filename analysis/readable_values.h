#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/tunable_values.h"

namespace pliant {

/// A value of a diagram whose numbers can be read: a port or a state. Of what is none of the other
/// kinds, such as a pose, the numbers stand one after the other.
struct ReadableValue : TunableValue {
  std::string role;      ///< input, output, held output, discrete, continuous
  bool tunable = false;  ///< it may be changed while its diagram runs
};

/// In order of declaration; a wired input shows what it is wired to. The diagram must outlive them.
std::vector<ReadableValue> ReadableValuesOf(const Diagram& diagram);

}  // namespace pliant
