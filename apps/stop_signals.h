#pragma once

#include <atomic>
#include <csignal>
#include <utility>
#include <vector>

namespace pliant {

/// While it lives, Ctrl-C and its like ask for a stop instead of ending the program; a second time
/// they end it. What was ignored from the start, as under nohup, stays so.
class StopSignals {
 public:
  StopSignals() {
    requested = false;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      const auto before = std::signal(signal, Stop);
      if (before == SIG_IGN) std::signal(signal, SIG_IGN);
      before_.emplace_back(signal, before);
    }
  }
  ~StopSignals() {
    for (const auto& [signal, before] : before_) std::signal(signal, before);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  static inline std::atomic<bool> requested{false};

 private:
  static void Stop(int signal) {
    requested = true;
    std::signal(signal, SIG_DFL);
  }

  std::vector<std::pair<int, void (*)(int)>> before_;
};

}  // namespace pliant
