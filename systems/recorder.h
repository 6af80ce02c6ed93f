#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/record_sink.h"
#include "pliant/systems/wired_numbers.h"

namespace pliant {

/// Hands values of any types made of numbers to a sink, at every tick of a period or at the start
/// and after every step of the integrator:
///
///   auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = log});
///   b.Connect(arm.velocity, recorder.in);
///
/// A row at a tick holds the values of that instant: held outputs new, states before their updates.
/// Its time is that of the tick, rounded to a nanosecond. The sink opens when the diagram is built.
/// A run that is restored to an earlier time hands on its rows again. Contexts of a diagram share
/// the sink, so they belong to one thread.
class Recorder final : public Block {
 public:
  struct Options {
    std::optional<Duration> period = {};  ///< none: at every step of the integrator
    std::shared_ptr<RecordSink> sink;
  };

  explicit Recorder(const Options& o)
      : in{this, "in"}, stream_{this, "stream", in, [sink = o.sink](const auto& sources) {
                                  return Stream(sink, sources);
                                }} {
    Require(o.sink != nullptr, "sink must be given");
    if (o.period) {
      RecordAt(Every(*o.period));
    } else {
      RecordAt(AtStart());
      RecordAt(AtEveryStep());
    }
  }

  AnyInputs in;

 private:
  class Stream {
   public:
    Stream() = default;
    Stream(std::shared_ptr<RecordSink> sink, const std::vector<internal::Source>& sources)
        : sink_{std::move(sink)}, numbers_{sources}, number_{sink_->Open(numbers_.values())} {}

    void Record(double t, const AnyValues& values) const {
      const std::span<double> row = sink_->Begin(number_, std::llround(1e9 * t));
      if (row.empty()) return;
      numbers_.Store(values, row);
      sink_->Commit();
    }

   private:
    std::shared_ptr<RecordSink> sink_;
    internal::WiredNumbers numbers_;
    int number_ = 0;
  };

  void RecordAt(const Event& event) {
    event.Publish().From(stream_, clock, in).As([](Stream& s, double t, const AnyValues& values) {
      s.Record(t, values);
    });
  }

  Scratch<Stream> stream_;
};

}  // namespace pliant
