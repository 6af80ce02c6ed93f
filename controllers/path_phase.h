#pragma once

#include "pliant/controllers/objective.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// The time φ that a reference reads, and its rates. Made by default it is the clock's.
struct PathTime {
  double phase = 0;                   ///< φ [s]
  double rate = 1, acceleration = 0;  ///< φ̇, φ̈ [1/s]
  bool by_clock = true;               ///< φ = t, whatever `phase` says

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("phase", phase, "s");
    f("rate", rate, "");
    f("acceleration", acceleration, "1/s");
    f("by_clock", by_clock, "");
  }
};

/// Lets a reference wait for what follows it: time runs slower as the frame deviates, and stands
/// still while it is held fast.
///
///   φ̈ = (ρ − φ̇)/T,   ρ = 1 − x² (3 − 2 x),   x = (‖e‖ − e₀)/(e₁ − e₀) held in [0, 1]
///
/// e is sampled every h and ρ held between the ticks; φ, φ̇ and φ̈ are the exact solution at any
/// time. So 0 ≤ φ̇ ≤ 1, |φ̈| ≤ 1/T, and φ = t to the bit as long as ‖e‖ has not been above e₀. What
/// was lost is not caught up with.
class PathPhase final : public Block {
 public:
  struct Options {
    int size = 6;              ///< of the error, rad and m alike
    double free = kToBeGiven;  ///< e₀ ≥ 0
    double stop = kToBeGiven;  ///< e₁ > e₀
    double lag_s = 0.1;        ///< T > 0
    Duration period = 1ms;     ///< h

    template <class F>
    void Parameters(F&& f) {
      f("free", free, "", kNotNegative);
      f("stop", stop, "", kPositive);
      f("lag_s", lag_s, "s", kPositive);
    }
  };

  explicit PathPhase(const Options& o);

  Input<TaskVector> error;  ///< of what follows the reference, as FrameTask has it
  Output<PathTime> phase;

 private:
  struct State {
    double since = 0;    ///< time of the last tick [s]
    double deficit = 0;  ///< t − φ at that time [s]
    double rate = 1;     ///< φ̇ at that time
    double goal = 1;     ///< ρ since then

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("since", since, "s");
      f("deficit", deficit, "s");
      f("rate", rate, "");
      f("goal", goal, "");
    }
  };

  State At(double t, const State& x) const;
  State Next(double t, const State& x, const TaskVector& e) const;
  PathTime Phase(double t, const State& x) const;

  const Options o_;
  Discrete<State> state_;
};

}  // namespace pliant
