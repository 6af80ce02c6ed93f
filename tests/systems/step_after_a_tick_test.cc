#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "pliant/systems/random.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

constexpr double kRate = 3000;  // λ [1/s]

/// A fast lag behind a sampled input, ẋ = λ (u_k − x): the jump of u at every millisecond begins a
/// transient that is over, but for e⁻³, at the next. u jumps between 10 and 11, or anywhere between
/// them: far from zero, so that all errors have the same weight.
class JumpingLag final : public Block {
 public:
  enum class Jumps { Alike, Random };

  explicit JumpingLag(Jumps jumps) : u{this, "u"}, x{this, "x", {}, 10.5}, jumps_{jumps} {
    Every(1ms).Compute(u).From(clock).As(&JumpingLag::Draw);
    Derivative(x).From(u, x).As([](double u_k, double now) { return kRate * (u_k - now); });
  }

  Output<double> u;
  Continuous<double> x;

 private:
  double Draw(double t) const {
    const std::uint64_t k = TickAt(t, 1e-3);
    return 10 + (jumps_ == Jumps::Alike ? static_cast<double>(k % 2) : random_.Uniform(k));
  }

  const Jumps jumps_;
  const RandomStream random_{7};
};

struct Lag {
  JumpingLag& lag;
  Diagram diagram;

  static Lag With(JumpingLag::Jumps jumps) {
    DiagramBuilder b;
    auto& lag = b.Add<JumpingLag>("lag", jumps);
    return {lag, b.Build()};
  }
};

/// Per tick, over 200 of them after the first ten.
struct Cost {
  double steps, rejected, derivatives;
};

Cost CostOf(const IntegratorOptions& integrator, JumpingLag::Jumps jumps) {
  const Lag run = Lag::With(jumps);
  Simulator sim{run.diagram, {.integrator = integrator}};
  sim.AdvanceTo(0.01);
  const Integrator::Statistics first = sim.statistics();
  sim.AdvanceTo(0.21);
  const Integrator::Statistics last = sim.statistics();
  const auto per_tick = [](std::int64_t from, std::int64_t to) {
    return static_cast<double>(to - from) / 200;
  };
  return {per_tick(first.steps, last.steps), per_tick(first.rejected_steps, last.rejected_steps),
          per_tick(first.derivative_calls, last.derivative_calls)};
}

// Not Heun–Euler: one in eight of its steps is rejected, wherever in a transient.
constexpr Method kMethods[] = {
    Method::kBogackiShampine, Method::kZonneveld,     Method::kSayfyAburub, Method::kCashKarp,
    Method::kFehlberg,        Method::kDormandPrince, Method::kSdirk};

// The step that suits the end of a transient, e⁻³ of its beginning, is e^{3/p} times too long for
// the next one and would be rejected at every tick.
TEST(StepAfterATick, FitsATransientLikeTheLast) {
  for (const Method method : kMethods) {
    const Cost cost =
        CostOf({.method = method, .relative_tolerance = 1e-5}, JumpingLag::Jumps::Alike);
    EXPECT_LT(cost.rejected, 0.1) << Name(method);
  }
}

// Each of two jumps in a row is the larger with probability ½; by three deviations of 200 draws.
TEST(StepAfterATick, IsRejectedAtHalfTheTicksByRandomJumps) {
  for (const Method method : kMethods) {
    const Cost cost =
        CostOf({.method = method, .relative_tolerance = 1e-5}, JumpingLag::Jumps::Random);
    EXPECT_LT(cost.rejected, 0.5 + 3 * std::sqrt(0.25 / 200)) << Name(method);
  }
}

// Where a step's error estimate is C (λ h)³ d, d = d₀ e^{−λ t} from u, steps of error 1 are
// h = (tol/(C d))^{1/3}/λ, and ∫ dt/h = 3 (C d₀/tol)^{1/3} (1 − e^{−λ T/3}) of them fill a tick.
TEST(StepAfterATick, CostsWhatTheTransientNeeds) {
  // R(z) − R̂(z) = z³/48 + O(z⁴): Bogacki & Shampine, Appl. Math. Letters 2(4), 1989.
  const double C = 1.0 / 48, tolerance = 1e-6 * 10.5, d0 = 1 / (1 + std::exp(-3));
  const double least = 3 * std::cbrt(C * d0 / tolerance) * (1 - std::exp(-1));
  const Cost cost = CostOf({}, JumpingLag::Jumps::Alike);
  EXPECT_LT(cost.steps, 1.5 * least);
  // Three calls a step, since its last is the next one's first; and the first of a tick.
  EXPECT_LE(cost.derivatives, 3 * (cost.steps + cost.rejected) + 1);
}

TEST(StepAfterATick, IsPartOfASnapshot) {
  for (const Method method : kMethods)
    for (const double at : {0.0503, 0.05}) {  // in the middle of a tick, and at one
      const Lag run = Lag::With(JumpingLag::Jumps::Random);
      Simulator sim{run.diagram, {.integrator = {.method = method, .relative_tolerance = 1e-4}}};
      sim.AdvanceTo(at);
      const Context start = sim.Snapshot();
      sim.AdvanceTo(0.08);
      const double x = sim.Get(run.lag.x);
      const Context end = sim.Snapshot();

      Simulator other{run.diagram, {.integrator = {.method = method, .relative_tolerance = 1e-4}}};
      other.AdvanceTo(0.0123);
      for (Simulator* again : {&sim, &other}) {
        again->Restore(start);
        again->AdvanceTo(0.08);
        EXPECT_EQ(again->Get(run.lag.x), x) << Name(method) << " from " << at;
        EXPECT_TRUE(again->Snapshot() == end) << Name(method) << " from " << at;
      }
    }
}

}  // namespace
}  // namespace pliant
