#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string>

namespace pliant {

/// How far a run is, on standard error: a line that is written over on a terminal, elsewhere a line
/// every 10 s and one at the end of each phase.
class ProgressLine {
 public:
  void operator()(const std::string& phase, double done_s, double total_s, double wall_s) {
    const auto now = std::chrono::steady_clock::now();
    const bool end = done_s >= total_s;
    if (!terminal_ && !end && now - shown_ < std::chrono::seconds(10)) return;
    shown_ = now;
    const double factor = wall_s > 0 ? done_s / wall_s : 0;
    std::fprintf(stderr, "%s%-28s %6.1f of %.1f s, %5.1f x real time", terminal_ ? "\r\033[K" : "",
                 phase.c_str(), done_s, total_s, factor);
    if (!end && factor > 0) std::fprintf(stderr, ", %.0f s left", (total_s - done_s) / factor);
    if (end || !terminal_) std::fputc('\n', stderr);
    std::fflush(stderr);
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

}  // namespace pliant
