#pragma once

#include <string>
#include <vector>

#include "pliant/systems/diagram.h"
#include "pliant/systems/time.h"

namespace pliant {

/// When something of a diagram changes.
struct Rates {
  std::vector<Duration> periods = {};  ///< of ticks, the shortest first, none twice
  bool continuous = false;             ///< with time, or with a continuous state
  bool events = false;                 ///< when a guard fires
  bool steps = false;                  ///< after each step of the integrator

  bool operator==(const Rates&) const = default;
  Rates& operator|=(const Rates& other);

  /// Such as {"continuous", "1 kHz", "events"}; empty for what never changes.
  std::vector<std::string> texts() const;
};

/// What a diagram is made of: the one description that pictures and lists of it are written from.
struct DiagramStructure {
  struct Block {
    std::string path, name;
    std::string type;         ///< in C++, such as "LowPass<JointVelocity>"
    int parent = -1;          ///< the composite it is a part of: its place in `blocks`, or −1
    bool composite = false;   ///< made of blocks
    bool integrates = false;  ///< it has a continuous state
    bool remembers = false;   ///< it has a discrete state, or a held output it reads itself
    bool records = false;     ///< it takes values of any types, as recorders and loggers do
    Rates rates = {};         ///< at which its rules run
    std::vector<std::string> free = {};  ///< paths of inputs that hold their default
  };

  /// From an output to an input, behind the ports of the composites between them.
  struct Wire {
    int from = 0, to = 0;  ///< their places in `blocks`
    std::string output, input;
    std::string type, unit;  ///< of the output
    Rates rates = {};        ///< at which it changes
  };

  std::vector<Block> blocks;  ///< in order of declaration, composites before their parts
  std::vector<ValueInfo> values;
  std::vector<Wire> wires;  ///< in the order of the inputs

  static DiagramStructure Of(const Diagram& diagram);
};

}  // namespace pliant
