#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pliant/systems/real_time_permissions.h"
#include "pliant/systems/simulator.h"
#include "pliant/systems/tick_timing.h"
#include "pliant/systems/time_histogram.h"

namespace pliant {

/// What to do about a tick that begins a period or more after its time.
enum class Overrun {
  Skip,     ///< the schedule moves on by whole periods: the diagram's clock falls behind
  CatchUp,  ///< late ticks follow at once until the run is on time again
  Stop,     ///< the run ends before that tick
};

/// Ended: by a block of the diagram, as Simulator::ended tells.
enum class RunEnd { TimeReached, StopAsked, Overran, Failed, Ended };

/// How a run went.
struct RunReport {
  RunEnd end = RunEnd::TimeReached;
  std::string reason;                ///< for its end
  std::vector<std::string> refused;  ///< permissions, each with the reason and the way out

  std::int64_t ticks = 0;    ///< begun
  std::int64_t missed = 0;   ///< that did not begin within their period
  std::int64_t skipped = 0;  ///< periods by which the schedule was moved on
  double behind = 0;         ///< [s] what the diagram's clock lost by that

  TimeHistogram period;    ///< from the beginning of a tick to that of the next
  TimeHistogram lateness;  ///< of the beginning of a tick against its time; of a paced run
  TimeHistogram compute;   ///< what a tick took, with the steps of the integrator before it

  std::string text() const;
};

/// Runs a simulator tick by tick against the wall clock (CLOCK_MONOTONIC). Tick k, at the time t_k
/// of the diagram, is due at W_k and begins at w_k ≥ W_k, when the thread wakes up:
///
///   W_k = s + (t_k − t_0) + S_k                  s: the wall time when the run begins, at t_0
///   L_k = w_k − W_k                              lateness
///   m_k = ⌊L_k / p⌋                              p: the shortest period of the diagram
///   S_{k+1} = S_k + p max(0, m_k − c)            c = 0 to skip, `catch_up` to catch up
///
/// All in whole nanoseconds. Periods that are skipped count as missed, and so does tick k if it is
/// still a period late after that. The values of the run are those of Simulator::AdvanceTo, bit for
/// bit, also with continuous states: these advance to t_k when tick k begins.
///
/// The loop by itself does not allocate, lock or throw, and its only system call is the sleep: the
/// clock is read through the vDSO, which makes none if the clock source can be read by programs, as
/// tsc can. What the rules do is theirs. An integrator that cannot go on throws as in AdvanceTo;
/// that ends the run and is passed on. Permissions are given back in any case.
class RealTimeRunner {
 public:
  struct Options {
    bool paced = true;  ///< false: as fast as it goes, in lock-step with what the rules wait for
    Overrun overrun = Overrun::Skip;  ///< of a paced run
    int catch_up = 10;                ///< late ticks to catch up at most, ≥ 1
    RealTimePermissions::Options permissions = {};
    std::shared_ptr<TickTimes> times = {};    ///< written before each tick, for TickTimer
    const std::atomic<bool>* stop = nullptr;  ///< asked at every tick and at every signal
    /// Called when a tick is due and its time is reached, before its events: to change inputs that
    /// nothing is connected to. Part of what the tick takes.
    std::function<void(Simulator&, const RunReport& now)> before_tick = {};
  };

  /// The simulator must outlive the runner.
  RealTimeRunner(Simulator& sim, const Options& options);

  /// Runs to `end` [s] of the diagram, before the events there, or until it is asked to stop or a
  /// block ends the run.
  const RunReport& Run(double end = std::numeric_limits<double>::infinity());

  /// Of the last run, also of one that an exception ended.
  const RunReport& report() const { return report_; }

 private:
  RunEnd Loop(std::int64_t end);
  bool WaitFor(std::int64_t wall) const;
  bool AskedToStop() const;
  std::int64_t Miss(std::int64_t periods);

  Simulator& sim_;
  const Options options_;
  const std::int64_t period_;    // p [ns]
  const std::int64_t catch_up_;  // c
  const std::shared_ptr<TickTimes> times_;
  RunReport report_;
};

}  // namespace pliant
