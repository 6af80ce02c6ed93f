#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// What the calling thread asks of the machine to be in time. What is refused is reported and not
/// thrown: the run goes on without it. All is given back when this ends, in the same thread; what
/// the process had locked by itself before is unlocked as well.
///
/// Memory that is there at the beginning is locked, and with it brought in: the heap, and as much
/// of the stack as a tick may take. Memory that other threads take later is theirs and stays as it
/// is, so that a small limit cannot starve them.
class RealTimePermissions {
 public:
  struct Options {
    std::optional<int> priority = {};  ///< of SCHED_FIFO, 1 … 99; none: the scheduler stays
    bool lock_memory = false;          ///< no page of the process is brought in or taken away
    std::optional<int> cpu = {};       ///< the processor to stay on; none: any
  };

  explicit RealTimePermissions(const Options& options);
  ~RealTimePermissions();
  RealTimePermissions(const RealTimePermissions&) = delete;
  RealTimePermissions& operator=(const RealTimePermissions&) = delete;

  /// What was asked for in vain: what, why, and the way out.
  const std::vector<std::string>& refused() const { return refused_; }

  static void Check(const Options& options);  ///< throws Error if what is asked for cannot be

 private:
  struct Before;

  void LockMemory();
  void StayOn(int cpu);
  void Prefer(int priority);

  std::unique_ptr<Before> before_;
  std::vector<std::string> refused_;
};

}  // namespace pliant
