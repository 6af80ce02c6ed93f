#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>

#include "pliant/analysis/printable.h"

namespace pliant {

/// How far a run is, on standard error: a line that is written over on a terminal, elsewhere a line
/// every 10 s, and one at the end of each run.
class ProgressLine {
 public:
  explicit ProgressLine(std::FILE* out = stderr) : ProgressLine(out, isatty(fileno(out)) != 0) {}
  ProgressLine(std::FILE* out, bool terminal) : out_{out}, terminal_{terminal} {}

  void operator()(const std::string& title, double done_s, double total_s, double wall_s) {
    const auto now = std::chrono::steady_clock::now();
    const bool end = done_s >= total_s;
    if (!end &&
        now - shown_ < (terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(10)))
      return;
    shown_ = now;
    const std::string phase = Printable(title);
    const double factor = wall_s > 0 ? done_s / wall_s : 0;
    const int digits = total_s < 10 ? 3 : 1;
    // As many blanks as letters are short of it, not bytes.
    const auto letters = std::ranges::count_if(phase, [](char c) { return (c & 0xC0) != 0x80; });
    const int blanks = static_cast<int>(std::max<std::ptrdiff_t>(0, 28 - letters));
    std::fprintf(out_, "%s%s%*s %6.*f of %.*f s, %5.1f x real time", terminal_ ? "\r\033[K" : "",
                 phase.c_str(), blanks, "", digits, done_s, digits, total_s, factor);
    if (!end && factor > 0) std::fprintf(out_, ", %.0f s left", (total_s - done_s) / factor);
    open_ = terminal_ && !end;
    if (!open_) std::fputc('\n', out_);
    std::fflush(out_);
  }

  /// Ends a line that would be written over: something else follows.
  void End() {
    if (std::exchange(open_, false)) std::fputc('\n', out_);
  }

 private:
  std::FILE* out_;
  bool terminal_;
  bool open_ = false;
  std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

}  // namespace pliant
