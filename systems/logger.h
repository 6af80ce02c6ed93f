#pragma once

#include <cstddef>
#include <optional>

#include "pliant/systems/log.h"

namespace pliant {

/// Records values of any types made of numbers, at every tick of a period or at the start and after
/// every step of the integrator:
///
///   auto& logger = b.Add<Logger>("logger", {.period = 1ms, .capacity = 60'000});
///   b.Connect(arm.velocity, logger.in);
///   …
///   sim.Get(logger.log)["arm.velocity[elbow]"]
///
/// A row at a tick holds the values of that instant: held outputs new, states before their updates.
/// The log is a workspace: snapshots do not hold it, and a run restored to an earlier time writes
/// over its later rows.
class Logger final : public Block {
 public:
  struct Options {
    std::optional<Duration> period = {};  ///< none: at every step of the integrator
    std::size_t capacity = 0;             ///< rows recorded without allocation; the log may grow on
  };

  explicit Logger(const Options& o)
      : in{this, "in"}, log{this, "log", in, [capacity = o.capacity](const auto& sources) {
                              return Log(sources, capacity);
                            }} {
    if (o.period) {
      RecordAt(Every(*o.period));
    } else {
      RecordAt(AtStart());
      RecordAt(AtEveryStep());
    }
  }

  AnyInputs in;
  Scratch<Log> log;

 private:
  void RecordAt(const Event& event) {
    event.Publish().From(log, clock, in).As([](Log& rows, double t, const AnyValues& values) {
      rows.Record(t, values);
    });
  }
};

}  // namespace pliant
