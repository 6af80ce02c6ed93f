#pragma once

#include <string>
#include <vector>

#include "pliant/systems/diagram.h"

namespace pliant {

/// What a tick of a diagram is likely to cost on this machine.
struct TickCost {
  struct Block {
    std::string path;
    double cost;  ///< [s] of its rules, each the median over the samples
    int rules;    ///< that run at a tick
  };

  double period;              ///< [s] the shortest of the diagram
  double cost;                ///< [s] of all blocks
  int rules;                  ///< of all blocks
  std::vector<Block> blocks;  ///< those with rules that run, the dearest first

  /// The sum, and the dearest blocks up to a number:
  ///
  ///   estimated 21 µs a tick of 1 ms, 214 rules; control.qp 6.1 µs, control.model 4.2 µs, …
  std::string text(int limit = 5) const;
};

/// Runs ticks in a context of its own and times each rule, less what it takes to read the clock. A
/// tick is the dearest there is: all rates are due. Held outputs are computed, then what publish
/// rules and updates need, then the updates; the next sample goes on from there, a shortest period
/// later. The initial values are those after the updates at start.
///
/// Publish rules, which have effects outside, do not run, and so their cost is not known. Neither
/// is that of the integrator, since continuous states stay where they are, nor what it costs when
/// values differ from those at the beginning: a solver with more to do, an input that a robot will
/// give, a memory cache that others use. Rules that ask a device do ask it.
TickCost EstimateTickCost(const Diagram& diagram, int samples = 100);

}  // namespace pliant
