// What a tick costs that records a hundred values, and how fast the writer is.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "pliant/analysis/mcap_log.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/recorder.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

constexpr int kValues = 100;

using Clock = std::chrono::steady_clock;

/// Notes how long each row takes from Begin to Commit, the clock's own time included.
class Timed final : public RecordSink {
 public:
  explicit Timed(std::shared_ptr<RecordSink> sink, std::size_t rows) : sink_{std::move(sink)} {
    ns.reserve(rows);
  }

  int Open(std::vector<RecordedValue> values) override { return sink_->Open(std::move(values)); }
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override {
    begin_ = Clock::now();
    return sink_->Begin(stream, time_ns);
  }
  void Commit() noexcept override {
    sink_->Commit();
    ns.push_back(std::chrono::duration<double, std::nano>(Clock::now() - begin_).count());
  }

  std::vector<double> ns;

 private:
  const std::shared_ptr<RecordSink> sink_;
  Clock::time_point begin_;
};

/// Noise of a sensor upon a slow movement, new at every tick.
template <class S>
class Noisy final : public Block {
 public:
  struct Options {
    typename internal::SpaceOf<S>::type space;
    S value;
    int seed;
  };
  explicit Noisy(const Options& o) : y{this, "y", o.space}, value_{o.value}, seed_{o.seed} {
    Every(1ms).Compute(y).From(clock).As(&Noisy::Next);
  }
  Output<S> y;

 private:
  S Next(double t) const {
    const double noise = std::fmod(std::sin(1e4 * (t + seed_)) * 43758.5453, 1);
    return S(value_ * (std::sin(t) + 1e-3 * noise));
  }
  const S value_;
  const int seed_;
};

template <class S>
S Unit();
template <>
double Unit() {
  return 1;
}
template <>
JointVelocity Unit() {
  return JointVelocity{1, 1, 1, 1, 1, 1, 1};
}

/// A hundred values of noise, recorded at 1 kHz.
template <class S>
Diagram RecordedNoise(const std::shared_ptr<RecordSink>& sink) {
  DiagramBuilder b;
  auto* const recorder =
      sink ? &b.Add<Recorder>("recorder", {.period = 1ms, .sink = sink}) : nullptr;
  for (int i = 0; i < kValues; ++i) {
    typename internal::SpaceOf<S>::type space;
    if constexpr (std::is_same_v<S, JointVelocity>) space = Joints::Numbered(7);
    auto& noisy = b.Add<Noisy<S>>("value_" + std::to_string(i),
                                  {.space = space, .value = Unit<S>(), .seed = i});
    if (recorder) b.Connect(noisy.y, recorder->in);
  }
  return b.Build();
}

std::filesystem::path File() {
  return std::filesystem::temp_directory_path() / "pliant_log_bench.mcap";
}

/// What a row costs in its tick, from Begin to Commit, at 1 kHz or in bursts of the same mean rate:
/// a row by itself finds the caches as cold as the rest of the program leaves them. The ring is
/// never full.
template <class S>
void RecordRow(benchmark::State& state) {
  const auto full = static_cast<McapLog::Full>(state.range(0));
  const auto burst = static_cast<int>(state.range(1));
  const auto log =
      std::make_shared<McapLog>(McapLog::Options{.file = File(), .force = true, .full = full});
  const auto timed =
      std::make_shared<Timed>(log, static_cast<std::size_t>(burst * state.max_iterations));
  DiagramBuilder b;
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = timed});
  for (int i = 0; i < kValues; ++i) {
    typename internal::SpaceOf<S>::type space;
    if constexpr (std::is_same_v<S, JointVelocity>) space = Joints::Numbered(7);
    auto& value =
        b.Add<Constant<S>>("value_" + std::to_string(i), {.space = space, .value = Unit<S>()});
    b.Connect(value.y, recorder.in);
  }
  const Diagram diagram = b.Build();
  Simulator sim{diagram};

  double t = 0;
  Clock::time_point next = Clock::now();
  for (auto _ : state) {
    std::this_thread::sleep_until(next += burst * 1ms);
    sim.AdvanceTo(t += 1e-3 * burst);
    double sum = 0;
    for (auto row = timed->ns.end() - burst; row != timed->ns.end(); ++row) sum += *row;
    state.SetIterationTime(1e-9 * sum / burst);
  }
  std::vector<double>& ns = timed->ns;
  std::ranges::sort(ns);
  state.counters["median_ns"] = ns[ns.size() / 2];
  state.counters["p99_ns"] = ns[ns.size() * 99 / 100];
  log->Close();
  state.counters["dropped"] = static_cast<double>(log->statistics().dropped);
  std::filesystem::remove(File());
}
void AtEachTick(benchmark::internal::Benchmark* b) {
  b->ArgNames({"full", "burst"})->ArgsProduct({{0, 1}, {1}})->Iterations(500)->UseManualTime();
}
void InBursts(benchmark::internal::Benchmark* b) {
  b->ArgNames({"full", "burst"})->ArgsProduct({{0, 1}, {100}})->Iterations(10)->UseManualTime();
}
BENCHMARK(RecordRow<double>)->Name("RecordRow/numbers")->Apply(AtEachTick);
BENCHMARK(RecordRow<double>)->Name("RecordRow/numbers")->Apply(InBursts);
BENCHMARK(RecordRow<JointVelocity>)->Name("RecordRow/joint_vectors")->Apply(AtEachTick);
BENCHMARK(RecordRow<JointVelocity>)->Name("RecordRow/joint_vectors")->Apply(InBursts);

/// A simulated minute at 1 kHz, as fast as it goes, until the file is closed.
template <class S>
void RecordMinute(benchmark::State& state) {
  for (auto _ : state) {
    const auto log = std::make_shared<McapLog>(McapLog::Options{.file = File(), .force = true});
    const Diagram diagram = RecordedNoise<S>(log);
    Simulator sim{diagram};
    sim.AdvanceTo(60);
    log->Close();
    state.counters["file_MB"] = 1e-6 * static_cast<double>(log->statistics().bytes);
  }
  std::filesystem::remove(File());
}
template <class S>
void UnrecordedMinute(benchmark::State& state) {
  for (auto _ : state) {
    const Diagram diagram = RecordedNoise<S>(nullptr);
    Simulator sim{diagram};
    sim.AdvanceTo(60);
  }
}
BENCHMARK(RecordMinute<double>)
    ->Name("Minute/numbers")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(UnrecordedMinute<double>)
    ->Name("Minute/numbers_unrecorded")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(RecordMinute<JointVelocity>)
    ->Name("Minute/joint_vectors")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(UnrecordedMinute<JointVelocity>)
    ->Name("Minute/joint_vectors_unrecorded")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace pliant
