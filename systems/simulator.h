#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/diagram.h"
#include "pliant/systems/integrator.h"

namespace pliant {

struct TickCost;

/// Advances a diagram in time.
///
/// Ticks fall on whole nanoseconds. At the instant of a tick:
///
///   1. held outputs due, in the order of the signals      y_k = f(y_{k−1}, u_k)
///   2. publish rules                                      they see x_k, y_k, u_k
///   3. updates due, which read x_k and the new y_k; then all are committed at once
///
/// Between ticks the continuous state follows SUNDIALS. A guard is sampled on the dense output of
/// every step, at least every `guard_spacing_s` and, after it fired, from a nanosecond on at
/// doubled distances; a change of sign is located to the resolution of a double. So two crossings
/// are found if they are further apart than the spacing. Guards go before a tick at the same
/// instant; a guard that jumps over zero at an event fires at once. A guard that is zero at start
/// has not crossed.
///
/// AdvanceTo(t) ends before the events at t, which begin the next call; a run split into many calls
/// is the same run, bit for bit.
///
/// A rule with Stop or StopIf ends the run: all events of that instant are gone through, time stays
/// there from then on, and `ended` tells why. A snapshot taken before leads back.
class Simulator {
 public:
  struct Options {
    IntegratorOptions integrator = {};
    double guard_spacing_s = 1e-3;  ///< > 0
    /// A guard that fires three times at intervals shorter than this is reported as Zeno behaviour.
    double zeno_interval_s = 1e-4;
  };

  /// Who ended a run and why: the first that asked, if several did at one instant. The texts live
  /// as long as the diagram.
  struct Ending {
    double time;             ///< [s]
    std::string_view block;  ///< its path
    std::string_view reason;

    std::string text() const;  ///< "ball ended the run at t = 0.45 s: it has reached the floor"
  };

  /// Counted since construction.
  struct Statistics : Integrator::Statistics {
    std::int64_t guards_fired = 0;

    std::string text() const;  ///< that of the integrator, and "2 guards fired"

    bool operator==(const Statistics&) const = default;
  };

  /// Starts at t = 0 with the initial values and runs the AtStart rules. The diagram must outlive
  /// the simulator.
  explicit Simulator(const Diagram& diagram) : Simulator(diagram, Options{}) {}
  Simulator(const Diagram& diagram, const Options& options);
  explicit Simulator(const Diagram&&) = delete;
  Simulator(const Diagram&&, const Options&) = delete;
  ~Simulator();

  /// Advances to t [s], rounded to whole nanoseconds. Throws Error if the integrator cannot: with
  /// the time, the state and the reason. After that, and after an exception of a rule, it stands
  /// before the step or at the event that failed; Restore leads out of both.
  void AdvanceTo(double t);

  /// Advances to the next tick and through it: its time is reached, and its outputs are held. A run
  /// that ends on the way there stays where it ended.
  void AdvanceThroughTick();

  /// Nothing while the run goes on.
  std::optional<Ending> ended() const;

  double time() const { return context_.time(); }
  /// When the next tick is [ns]; beyond any time if nothing ticks.
  std::int64_t next_tick_ns() const;

  template <class V>
  const typename V::Signal& Get(const V& value) {
    return context_.Get(value);
  }

  /// Changes an unconnected input or a state now.
  template <class V>
  void Set(const V& value, const typename V::Signal& x) {
    LookHere();
    context_.Set(value, x);
    Restart();
  }

  /// The same for a value whose type is not known, by its numbers in the order of a log's columns.
  void GetNumbers(const internal::Value& value, std::span<double> numbers) {
    context_.GetNumbers(value, numbers);
  }
  void SetNumbers(const internal::Value& value, std::span<const double> numbers) {
    LookHere();
    context_.SetNumbers(value, numbers);
    Restart();
  }

  /// A copy of everything that changes. Taking it resets the integrator, so that the run that goes
  /// on and a run restored from it are the same, bit for bit.
  Context Snapshot();
  void Restore(const Context& snapshot);

  /// The same to and from a file. A failed Save leaves an older file as it was.
  void Save(const std::filesystem::path& file);
  void Restore(const std::filesystem::path& file);

  /// To read. What is set through it is not seen by the integrator: use Set.
  Context& context() { return context_; }
  const Diagram& diagram() const { return diagram_; }
  Statistics statistics() const;

 private:
  friend TickCost EstimateTickCost(const Diagram& diagram, int samples);
  class TickMeter;

  static bool Rate(void* self, double t, std::span<const double> x, std::span<double> rate);

  void Start();
  void Restart();
  void Settle();
  void TakeStep();
  void GiveUpStep(double step);
  void Show(double t);
  void Tick();
  bool HasEnded() const { return context_.line_.ended_by >= 0; }
  bool Happens();
  double TickTime() const;
  void Fire(std::size_t guard);
  void Update(const internal::Happening& h);
  void PublishAll(const internal::Happening& h);

  double GuardNow(std::size_t guard);
  double GuardAt(std::size_t guard, double t);
  bool Crosses(std::size_t guard, double before, double now) const;
  double Locate(std::size_t guard, double a, double b);
  void SampleGuards(double from, double to);
  void CheckFallingThrough(std::size_t guard, double t) const;
  void LookHere();
  void FindJumps();
  double StopTime() const;
  std::size_t NextRate() const;

  const Diagram& diagram_;
  const internal::Plan& plan_;
  Options options_;
  Context context_;
  std::unique_ptr<Integrator> integrator_;  // none without continuous states

  double lo_ = 0, hi_ = 0;  // the integrator's last step, cut at a guard
  int guard_ = -1;          // the guard that fires at hi_
  bool begins_ = true;      // no step was taken since the integrator was reset
  bool fresh_ = true;       // lo_ is an event: sample guards finely behind it
  int fired_last_ = -1;
  std::int64_t guards_fired_ = 0;
  std::vector<double> sides_;           // of the guards, at a sample
  std::vector<double> buffer_, begin_;  // states: on their way to the context, and at lo_
};

}  // namespace pliant
