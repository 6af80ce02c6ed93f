#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/systems/diagram.h"

namespace pliant {

/// Ports and states of any types made of numbers; written `{arm.position, arm.velocity}`.
using Values = std::vector<std::reference_wrapper<const internal::Value>>;

/// Between which ports a diagram is linearised.
struct Ports {
  Values inputs = {};   ///< unconnected
  Values outputs = {};  ///< or anything else that can be read
};

/// δẋ = A δx + B δu,   δy = C δx + D δu,
///
/// or, of a sampled diagram, δx⁺ = A δx + B δu.
struct Linearization {
  Eigen::MatrixXd A, B, C, D;
  std::vector<std::string> states, inputs, outputs;  ///< such as "arm.velocity[elbow]"
};

/// Linearises about a context by central differences with the step h = (3 ε)^(1/3) max(1, |x|), ε
/// the resolution of a double: the error of an entry is near h² |f‴|/6 + ε |f|/h. Source: Nocedal &
/// Wright, Numerical Optimization, 2nd ed., 8.1.
///
/// x are the Continuous values. What only events change, Discrete values and held outputs, keeps
/// its value: let it reach it first.
Linearization Linearize(const Diagram& diagram, const Context& about, const Ports& ports);

/// The same of a diagram of one sample rate without Continuous values, over the tick that is next.
/// x are its Discrete values and held outputs, whether another value follows from them or not; y is
/// what the outputs show once the tick is over. Numbers of a type that is whole do not vary.
Linearization LinearizeSampled(const Diagram& diagram, const Context& about, const Ports& ports);

struct EquilibriumOptions {
  double tolerance = 1e-9;  ///< on every |ẋ|, > 0
  int most_steps = 100;     ///< ≥ 1
};

/// A context with ẋ = 0, reached from `start` by changing only the `free` values: unconnected
/// inputs and Continuous values. Where there are many, one near `start`. Throws Error, with the
/// state that moves most, if it finds none. Source: Levenberg–Marquardt, Nocedal & Wright, 10.3,
/// with differences as in Linearize.
Context FindEquilibrium(const Diagram& diagram, const Context& start, const Values& free,
                        const EquilibriumOptions& o = {});

}  // namespace pliant
