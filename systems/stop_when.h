#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/parameter.h"
#include "pliant/systems/wired_numbers.h"

namespace pliant {

/// Ends a run at the first tick at which a number is above or below a limit:
///
///   auto& stop = b.Add<StopWhen>(
///       "stop", {.number = "arm.velocity[elbow]", .above = 1.5, .period = 1ms});
///   b.Connect(arm.velocity, stop.in);
///
/// NaN is neither above nor below.
class StopWhen final : public Block {
 public:
  struct Options {
    std::string number;  ///< as a log names it: the path of a value, and its element
    std::optional<double> above = {}, below = {};  ///< at least one, in the unit of the value
    Duration period = 1ms;

    template <class F>
    void Parameters(F&& f) {
      f("number", number);
      f("above", above);
      f("below", below);
    }
  };

  explicit StopWhen(const Options& o)
      : in{this, "in"},
        picked_{this, "picked", in, [name = o.number](const auto& s) { return Picked(name, s); }},
        above_{o.above.value_or(kUnbounded)},
        below_{o.below.value_or(-kUnbounded)} {
    Require(o.above || o.below, "above or below must be given, the limit at which the run ends");
    Every(o.period).StopIf(ReasonOf(o)).From(picked_, in).As(&StopWhen::IsOver);
  }

  AnyInputs in;  ///< values of any types, of which one has the number

 private:
  /// Finds the number among those that are wired.
  class Picked {
   public:
    Picked() = default;
    Picked(const std::string& name, const std::vector<internal::Source>& sources)
        : numbers_{sources}, row_(numbers_.size()) {
      std::vector<std::string> names;
      for (const RecordedValue& value : numbers_.values())
        for (const std::string& element : value.elements) names.push_back(value.path + element);
      const auto at = std::ranges::find(names, name);
      if (at == names.end())
        throw Error("there is no number '" + name + "'" + DidYouMean(name, names));
      at_ = static_cast<std::size_t>(at - names.begin());
    }

    double Number(const AnyValues& values) {
      numbers_.Store(values, row_);
      return row_[at_];
    }

   private:
    internal::WiredNumbers numbers_;
    std::vector<double> row_;
    std::size_t at_ = 0;
  };

  static std::string ReasonOf(const Options& o) {
    return o.number + " is " + (o.above ? "above " + Text(*o.above) : "") +
           (o.above && o.below ? " or " : "") + (o.below ? "below " + Text(*o.below) : "");
  }

  bool IsOver(Picked& picked, const AnyValues& values) const {
    const double x = picked.Number(values);
    return x > above_ || x < below_;
  }

  Scratch<Picked> picked_;
  const double above_, below_;
};

}  // namespace pliant
