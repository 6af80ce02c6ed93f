#pragma once

#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// The residual of an observer without what it shows of an arm that nobody touches: the offset of
/// the torque sensors and the error of the model where the arm stands,
///
///   y = r − r̄,   r̄: the mean of r from `from_s` to `until_s`
///
/// sampled every h; zero until then. With until_s = 0 it is r all along.
///
/// Assumes that the arm rests untouched while the mean is taken, and that the observer has settled
/// before, exp(−K from_s) ≪ 1. What the error of the model is elsewhere stays in y.
class ResidualTare final : public Block {
 public:
  struct Options {
    Joints joints;
    Duration period;      ///< h
    double from_s = 0.5;  ///< ≥ 0
    double until_s = 1.5;

    template <class F>
    void Parameters(F&& f) {
      f("from_s", from_s, "s", kNotNegative);
      f("until_s", until_s, "s", kNotNegative);
    }
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    using Space = Joints;
    static constexpr Quantity quantity{"residual tare memory", ""};

    JointTorque sum;
    int samples = 0;
    JointTorque y;
    bool ready = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("sum", sum, "N·m");
      f("samples", samples, "");
      f("y", y, "N·m");
      f("ready", ready, "");
    }
  };

  explicit ResidualTare(const Options& o);

  Input<JointTorque> residual;  ///< r
  Output<JointTorque> tared;    ///< y
  Output<bool> ready;           ///< whether the mean is there

 private:
  Memory Next(const Memory& last, double t, const JointTorque& r) const;

  const double from_, until_;
  Output<Memory> memory_;
};

}  // namespace pliant
