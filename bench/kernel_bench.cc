// What the kernel costs. Names and counters are those of bench/figures.tsv.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/real_time_runner.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"

namespace pliant {
namespace {

const Joints kJoints = Joints::Numbered(7);
const PerJoint kOnes = PerJoint::Ones(7);

/// Counts what a benchmark takes from the heap between its construction and the end of its loop.
class AllocationCount {
 public:
  explicit AllocationCount(benchmark::State& state) : state_{state} {}
  ~AllocationCount() {
    state_.counters["allocations"] =
        static_cast<double>(Allocations() - before_) /
        static_cast<double>(std::max<std::int64_t>(1, state_.iterations()));
  }

 private:
  benchmark::State& state_;
  const long before_ = Allocations();
};

/// CPU time per block and iteration.
void CountPerBlock(benchmark::State& state) {
  state.counters["per_block_ns"] = benchmark::Counter(
      1e-9 * static_cast<double>(state.range(0)),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// source ─▶ gain_1 ─▶ … ─▶ gain_N
struct Chain {
  const Constant<JointTorque>* source;
  const Output<JointTorque>* last;
  Diagram diagram;
};

Chain MakeChain(std::int64_t n) {
  DiagramBuilder b;
  const auto& source = b.Add<Constant<JointTorque>>(
      "source", {.space = kJoints, .value = JointTorque::Zero(kJoints)});
  const Output<JointTorque>* last = &source.y;
  for (std::int64_t i = 1; i <= n; ++i) {
    auto& gain =
        b.Add<Gain<JointTorque>>("gain_" + std::to_string(i), {.space = kJoints, .gain = 1.0001});
    b.Connect(*last, gain.u);
    last = &gain.y;
  }
  return {&source, last, b.Build()};
}

void GainChainInputChanged(benchmark::State& state) {
  const Chain chain = MakeChain(state.range(0));
  Context context = chain.diagram.MakeContext();
  JointTorque u = JointTorque::Zero(kJoints);
  CountPerBlock(state);
  const AllocationCount count(state);
  for (auto _ : state) {
    u(0) += 1;
    context.Set(chain.source->value, u);
    benchmark::DoNotOptimize(context.Get(*chain.last).data());
  }
}
BENCHMARK(GainChainInputChanged)
    ->Name("GainChain/InputChanged")
    ->RangeMultiplier(10)
    ->Range(10, 10'000);

void GainChainTimeChanged(benchmark::State& state) {
  const Chain chain = MakeChain(state.range(0));
  Simulator sim{chain.diagram};
  sim.Get(*chain.last);
  const std::uint64_t before = sim.context().rules_run();
  double t = 0;
  {
    const AllocationCount count(state);
    for (auto _ : state) {
      sim.AdvanceTo(t += 1e-3);
      benchmark::DoNotOptimize(sim.Get(*chain.last).data());
    }
  }
  state.counters["rules"] = static_cast<double>(sim.context().rules_run() - before);
}
BENCHMARK(GainChainTimeChanged)
    ->Name("GainChain/TimeChanged")
    ->RangeMultiplier(10)
    ->Range(10, 10'000);

void CachedRead(benchmark::State& state) {
  const Chain chain = MakeChain(100);
  Context context = chain.diagram.MakeContext();
  const AllocationCount count(state);
  for (auto _ : state) benchmark::DoNotOptimize(context.Get(*chain.last).data());
}
BENCHMARK(CachedRead);

/// τ = K (q₀ − q) − D v, at every tick, with q₀ = ±0.1 rad changing sides twice a second: numbers
/// that die away would end as denormal ones, which are slow.
class Controller final : public Block {
 public:
  Controller()
      : position{this, "position", kJoints, JointPosition::Zero(kJoints)},
        velocity{this, "velocity", kJoints, JointVelocity::Zero(kJoints)},
        torque{this, "torque", kJoints} {
    Every(1ms).Compute(torque).From(position, velocity, clock).As(&Controller::Law);
  }
  JointTorque Law(const JointPosition& q, const JointVelocity& v, double t) const {
    const double rest = t - std::floor(t) < 0.5 ? 0.1 : -0.1;
    return stiffness_.cwiseProduct(rest * kOnes - q) - damping_.cwiseProduct(v);
  }

  Input<JointPosition> position;
  Input<JointVelocity> velocity;
  Output<JointTorque> torque;

 private:
  const PerJoint stiffness_ = 100 * kOnes, damping_ = 5 * kOnes;
};

/// Each joint pulls on every other: q̇ = v, v̇ = A q + B v + τ.
class Plant final : public Block {
 public:
  Plant()
      : torque{this, "torque", kJoints},
        position{this, "position", kJoints},
        velocity{this, "velocity", kJoints},
        q_{this, "q", kJoints},
        v_{this, "v", kJoints} {
    Derivative(q_).From(v_).As([](const JointVelocity& v) { return v; });
    Derivative(v_).From(q_, v_, torque).As(&Plant::Acceleration);
    Compute(position).From(q_).As([](const JointPosition& q) { return q; });
    Compute(velocity).From(v_).As([](const JointVelocity& v) { return v; });
  }
  JointAcceleration Acceleration(const JointPosition& q, const JointVelocity& v,
                                 const JointTorque& tau) const {
    JointAcceleration a = JointAcceleration::Zero(kJoints);
    a.noalias() += A * q;
    a.noalias() += B * v;
    a += tau;
    return a;
  }

  Input<JointTorque> torque;
  Output<JointPosition> position;
  Output<JointVelocity> velocity;

  const JointMatrix A = JointMatrix::Constant(7, 7, -0.5), B = JointMatrix::Constant(7, 7, -0.1);

 private:
  Continuous<JointPosition> q_;
  Continuous<JointVelocity> v_;
};

/// controller ─▶ gain_1 ─▶ … ─▶ gain_20
struct Cycle {
  const Output<JointTorque>* last;
  Diagram diagram;
};

Cycle MakeCycle() {
  DiagramBuilder b;
  auto& controller = b.Add<Controller>("controller");
  const Output<JointTorque>* last = &controller.torque;
  for (int i = 1; i <= 20; ++i) {
    auto& gain =
        b.Add<Gain<JointTorque>>("gain_" + std::to_string(i), {.space = kJoints, .gain = 1.0001});
    b.Connect(*last, gain.u);
    last = &gain.y;
  }
  return {last, b.Build()};
}

void DiscreteCycle(benchmark::State& state) {
  const Cycle cycle = MakeCycle();
  Simulator sim{cycle.diagram};
  double t = 0;
  const AllocationCount count(state);
  for (auto _ : state) {
    sim.AdvanceTo(t += 1e-3);
    benchmark::DoNotOptimize(sim.Get(*cycle.last).data());
  }
}
BENCHMARK(DiscreteCycle);

/// What the runner adds to a tick: two looks at the clock and two counts. It is unpaced; in turns
/// with the simulator alone, so that the load of the machine falls on both alike.
void RunnerTick(benchmark::State& state) {
  constexpr int kTicks = 10'000;
  const Cycle cycle = MakeCycle();
  Simulator alone{cycle.diagram}, run{cycle.diagram};
  RealTimeRunner runner{run, {.paced = false}};
  std::vector<double> overheads;
  const auto measure = [](const auto& act) {
    const std::clock_t start = std::clock();
    act();
    return 1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / kTicks;
  };
  double end = 0;
  for (auto _ : state) {
    end += 1e-3 * kTicks;
    const double simulator = measure([&] {
      for (int k = 0; k < kTicks; ++k) alone.AdvanceThroughTick();
    });
    overheads.push_back(measure([&] { runner.Run(end); }) - simulator);
  }
  if (runner.report().ticks != kTicks) state.SkipWithError("ticks were lost");
  const auto middle = overheads.begin() + static_cast<std::ptrdiff_t>(overheads.size() / 2);
  std::ranges::nth_element(overheads, middle);
  state.counters["overhead_ns"] = *middle;
}
BENCHMARK(RunnerTick)->Unit(benchmark::kMillisecond);

/// plant.velocity ─▶ filter ─▶ controller ─▶ plant
struct Loop {
  Plant& plant;
  Diagram diagram;
};

const LowPass<JointVelocity>::Options kFilter{.space = kJoints, .cutoff_hz = 30, .period = 1ms};

Loop MakeLoop() {
  DiagramBuilder b;
  auto& plant = b.Add<Plant>("plant");
  auto& filter = b.Add<LowPass<JointVelocity>>("filter", kFilter);
  auto& controller = b.Add<Controller>("controller");
  b.Connect(plant.velocity, filter.u);
  b.Connect(plant.position, controller.position);
  b.Connect(filter.y, controller.velocity);
  b.Connect(controller.torque, plant.torque);
  return {plant, b.Build()};
}

/// A millisecond of the loop by the diagram.
class DiagramTick {
 public:
  explicit DiagramTick(const IntegratorOptions& options)
      : sim_{loop_.diagram, {.integrator = options}} {}
  void operator()() { sim_.AdvanceTo(t_ += 1e-3); }
  double q() { return sim_.Get(loop_.plant.position)(0); }

 private:
  Loop loop_ = MakeLoop();
  Simulator sim_;
  double t_ = 0;
};

/// The same arithmetic without a diagram.
class WrittenByHand {
 public:
  double q() const { return q_(0); }

 protected:
  /// What happens at a tick.
  void Control() {
    filtered_ = filtered_ + kAlpha * (v_ - filtered_);
    tau_ = controller_.Law(q_, filtered_, static_cast<double>(k_++) / 1e3);
  }

  const Plant plant_;
  const Controller controller_;
  const double kAlpha = 1 - std::exp(-2 * std::numbers::pi * 30 * 1e-3);
  JointPosition q_ = JointPosition::Zero(kJoints);
  JointVelocity v_ = JointVelocity::Zero(kJoints), filtered_ = JointVelocity::Zero(kJoints);
  JointTorque tau_ = JointTorque::Zero(kJoints);
  std::int64_t k_ = 0;
};

/// With the classic Runge–Kutta method.
class RungeKuttaTick : public WrittenByHand {
 public:
  void operator()() {
    Control();
    const JointVelocity v1 = v_, v2 = v_ + h / 2 * a(q_, v1);
    const JointAcceleration a1 = a(q_, v1), a2 = a(q_ + h / 2 * v1, v2);
    const JointVelocity v3 = v_ + h / 2 * a2;
    const JointAcceleration a3 = a(q_ + h / 2 * v2, v3);
    const JointVelocity v4 = v_ + h * a3;
    const JointAcceleration a4 = a(q_ + h * v3, v4);
    q_ += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    v_ += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }

 private:
  JointAcceleration a(const JointPosition& q, const JointVelocity& v) const {
    return plant_.Acceleration(q, v, tau_);
  }
  static constexpr double h = 1e-3;
};

/// With the integrator of the diagram.
class SundialsTick : public WrittenByHand {
 public:
  explicit SundialsTick(const IntegratorOptions& options)
      : integrator_{MakeIntegrator(options, 14, Derivatives(&SundialsTick::Rate, this))} {}
  void operator()() {
    Control();
    Half(0) = q_;
    Half(7) = v_;
    integrator_->Reset(t_, y_, step_);
    const double end = static_cast<double>(k_) / 1e3;
    while (t_ < end) t_ = integrator_->Step(end);
    step_ = integrator_->next_step();
    integrator_->Interpolate(t_, y_);
    q_ = Half(0);
    v_ = Half(7);
  }

 private:
  Eigen::Map<Eigen::VectorXd> Half(std::size_t first) {
    return Eigen::Map<Eigen::VectorXd>(y_.data() + first, 7);
  }
  static bool Rate(void* self, double, std::span<const double> y, std::span<double> rate) {
    const auto& tick = *static_cast<const SundialsTick*>(self);
    const JointPosition q = Eigen::Map<const Eigen::VectorXd>(y.data(), 7);
    const JointVelocity v = Eigen::Map<const Eigen::VectorXd>(y.data() + 7, 7);
    Eigen::Map<Eigen::VectorXd>(rate.data(), 7) = v;
    Eigen::Map<Eigen::VectorXd>(rate.data() + 7, 7) = tick.plant_.Acceleration(q, v, tick.tau_);
    return true;
  }

  std::unique_ptr<Integrator> integrator_;
  std::array<double, 14> y_;
  double t_ = 0, step_ = 0;
};

// Order 4, as the loop written by hand.
const IntegratorOptions kFixed{.method = Method::kZonneveld, .fixed_step_s = 1e-3};
const IntegratorOptions kAdaptive{};

template <class Tick>
void RunTicks(benchmark::State& state, Tick& tick) {
  for (int i = 0; i < 1000; ++i) tick();
  const AllocationCount count(state);
  for (auto _ : state) tick();
  benchmark::DoNotOptimize(tick.q());
}

void PlantTickHandWritten(benchmark::State& state) {
  RungeKuttaTick tick;
  RunTicks(state, tick);
}
BENCHMARK(PlantTickHandWritten)->Name("PlantTick/HandWritten");

void PlantTickOnSundials(benchmark::State& state) {
  SundialsTick tick{kFixed};
  RunTicks(state, tick);
}
BENCHMARK(PlantTickOnSundials)->Name("PlantTick/HandWrittenOnSundials");

void PlantTickFixedStep(benchmark::State& state) {
  DiagramTick tick{kFixed};
  RunTicks(state, tick);
}
BENCHMARK(PlantTickFixedStep)->Name("PlantTick/FixedStep");

void PlantTickAdaptive(benchmark::State& state) {
  DiagramTick tick{kAdaptive};
  RunTicks(state, tick);
}
BENCHMARK(PlantTickAdaptive)->Name("PlantTick/Adaptive");

/// All three in turn, so that the load of the machine falls on each alike. SUNDIALS' own share is
/// what the loop on its integrator costs more than the one with Runge and Kutta's method.
void PlantTickRatio(benchmark::State& state) {
  RungeKuttaTick by_hand;
  SundialsTick on_sundials{kFixed};
  DiagramTick by_diagram{kFixed};
  std::vector<double> over_hand, over_sundials;
  const auto measure = [](auto& tick) {
    const std::clock_t start = std::clock();
    for (int i = 0; i < 2000; ++i) tick();
    return static_cast<double>(std::clock() - start);
  };
  for (auto _ : state) {
    const double hand = measure(by_hand), sundials = measure(on_sundials);
    const double diagram = measure(by_diagram);
    over_hand.push_back(diagram / hand);
    over_sundials.push_back(diagram / std::max(hand, sundials));
  }
  const auto median = [](std::vector<double>& x) {
    std::ranges::nth_element(x, x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2));
    return x[x.size() / 2];
  };
  if (std::abs(by_hand.q() - by_diagram.q()) > 1e-9 ||
      std::abs(on_sundials.q() - by_diagram.q()) > 1e-12)
    state.SkipWithError("the loops disagree");
  state.counters["over_hand_written"] = median(over_hand);
  state.counters["over_hand_written_on_sundials"] = median(over_sundials);
}
BENCHMARK(PlantTickRatio)->Name("PlantTick/Ratio")->Unit(benchmark::kMillisecond);

void Build(benchmark::State& state) {
  CountPerBlock(state);
  for (auto _ : state) {
    auto chain = std::make_unique<Chain>(MakeChain(state.range(0)));
    state.PauseTiming();
    chain.reset();
    state.ResumeTiming();
  }
}
BENCHMARK(Build)->Arg(1000)->Arg(10'000)->Unit(benchmark::kMillisecond);

void ContextMemory(benchmark::State& state) {
  const Chain chain = MakeChain(state.range(0));
  std::size_t bytes = 0;
  for (auto _ : state) bytes = chain.diagram.MakeContext().bytes();
  const auto blocks = static_cast<double>(state.range(0));
  state.counters["bytes_per_block"] =
      (static_cast<double>(bytes) - (blocks + 2) * sizeof(JointTorque)) / blocks;
}
BENCHMARK(ContextMemory)->Arg(1000)->Arg(10'000)->Unit(benchmark::kMicrosecond);

/// ḧ = −g; at h = 0 the velocity turns round: ḣ⁺ = −e ḣ⁻.
class Ball final : public Block {
 public:
  explicit Ball(std::vector<double>& bounces)
      : height{this, "height"}, h_{this, "h", {}, 1.0}, v_{this, "v"} {
    Derivative(h_).From(v_).As([](double v) { return v; });
    Derivative(v_).From().As([] { return -kGravity; });
    Compute(height).From(h_).As([](double h) { return h; });
    const auto impact = When(height).Crosses(Direction::Falling);
    impact.Update(v_).From(v_).As([](double v) { return -0.9 * v; });
    impact.Publish().From(clock).As([&bounces](double t) { bounces.push_back(t); });
  }
  static constexpr double kGravity = 9.81;

  Output<double> height;

 private:
  Continuous<double> h_, v_;
};

void BouncingBall(benchmark::State& state) {
  std::vector<double> bounces;
  bounces.reserve(16);
  DiagramBuilder b;
  b.Add<Ball>("ball", bounces);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  const Context start = sim.Snapshot();
  std::int64_t calls = 0;
  for (auto _ : state) {
    bounces.clear();
    sim.Restore(start);
    const std::int64_t before = sim.statistics().derivative_calls;
    sim.AdvanceTo(3);
    calls = sim.statistics().derivative_calls - before;
  }
  const double fall = std::sqrt(2 / Ball::kGravity);
  double expected = fall, worst = bounces.size() == 4 ? 0 : 1;
  for (std::size_t i = 0; i < bounces.size(); ++i) {
    worst = std::max(worst, std::abs(bounces[i] - expected));
    expected += 2 * fall * std::pow(0.9, i + 1);
  }
  state.counters["worst_error_s"] = worst;
  state.counters["derivative_calls"] = static_cast<double>(calls);
}
BENCHMARK(BouncingBall)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pliant
