#pragma once

#include <vector>

#include "pliant/systems/number_vector.h"
#include "pliant/systems/wired_numbers.h"

namespace pliant {

/// One vector of all numbers that are wired to it, in the order of the wires:
///
///   y = (u₁; u₂; …)
///
///   auto& state = b.Add<Multiplexer>("state", {.names = Names::Numbered(14)});
///   b.Connect(arm.position, state.u);
///   b.Connect(arm.velocity, state.u);
class Multiplexer final : public Block {
 public:
  struct Options {
    Names names;  ///< one for each number
  };

  explicit Multiplexer(const Options& o)
      : u{this, "u"},
        y{this, "y", o.names},
        wired_{this, "wired", u, [n = o.names.size()](const auto& s) { return Wired(n, s); }} {
    Compute(y).From(wired_, u).As([](NumberVector& all, Wired& wired, const AnyValues& values) {
      wired.numbers.Store(values, {all.data(), static_cast<std::size_t>(all.size())});
    });
  }

  AnyInputs u;
  Output<NumberVector> y;

 private:
  struct Wired {
    Wired() = default;
    Wired(int names, const std::vector<internal::Source>& sources) : numbers{sources} {
      if (numbers.size() == static_cast<std::size_t>(names)) return;
      std::string found;
      for (const RecordedValue& value : numbers.values())
        found += "\n  " + value.path + ": " + Text(value.elements.size());
      throw Error("names must be as many as the numbers that are wired to it, " +
                  Text(numbers.size()) + ", got " + Text(names) + found);
    }
    internal::WiredNumbers numbers;
  };

  Scratch<Wired> wired_;
};

}  // namespace pliant
