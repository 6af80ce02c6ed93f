#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

/// ẋ = 1 from 0: the guard x − at passes zero at t = at. Every 10 ms the rate is set anew, so that
/// steps end there.
class Ramp final : public Block {
 public:
  struct Options {
    double at;
  };

  explicit Ramp(const Options& o) : guard{this, "guard"}, at_{o.at} {
    Derivative(x_).From(rate_).As([](double rate) { return rate; });
    Every(10ms).Update(rate_, ticks_).From(rate_, ticks_).As([](double rate, int ticks) {
      return std::tuple{rate, ticks + 1};
    });
    Compute(guard).From(x_).As(&Ramp::Distance);
    When(guard)
        .Crosses(Direction::Rising)
        .Update(fired_, before_)
        .From(fired_, ticks_)
        .As([](int fired, int ticks) {
          return std::tuple{fired + 1, ticks};
        });
  }

  Output<double> guard;

 private:
  double Distance(double x) const { return x - at_; }

  const double at_;
  Continuous<double> x_{this, "x"};
  Discrete<double> rate_{this, "rate", {}, 1.0};
  Discrete<int> ticks_{this, "ticks"};

 public:
  Discrete<int> fired_{this, "fired"};
  Discrete<int> before_{this, "before"};  // ticks done when the guard fired
};

// The guard goes first, also where only round-off lies between it and the tick, and the run goes
// on.
TEST(GuardBesideATick, FiresOnceAndFirst) {
  for (const Method method : {Method::kHeunEuler, Method::kBogackiShampine, Method::kZonneveld,
                              Method::kSayfyAburub, Method::kCashKarp, Method::kFehlberg,
                              Method::kDormandPrince, Method::kSdirk, Method::kAdams, Method::kBdf})
    for (const double at : {0.05, std::nextafter(0.05, 0), std::nextafter(0.05, 1), 0.05 - 1e-16,
                            0.05 - 2e-15, 0.05 - 1e-12}) {
      DiagramBuilder b;
      auto& ramp = b.Add<Ramp>("ramp", {.at = at});
      const Diagram diagram = b.Build();
      Simulator sim{diagram, {.integrator = {.method = method}}};
      sim.AdvanceTo(0.2);
      const std::string where = std::string(Name(method)) + ", at 0.05 - " + Text(0.05 - at);
      EXPECT_EQ(sim.Get(ramp.fired_), 1) << where;
      // ticks at 0, 10, … 40 ms come before; that at 50 ms only if x has not got there by then
      EXPECT_NEAR(sim.Get(ramp.before_), 5, at <= 0.05 - 1e-12 ? 0 : 1) << where;
    }
}

TEST(Restore, OfANewContextStartsFromTheVeryBeginning) {
  DiagramBuilder b;
  auto& ramp = b.Add<Ramp>("ramp", {.at = 0.03});
  const Diagram diagram = b.Build();
  Simulator used{diagram}, fresh{diagram};
  used.AdvanceTo(0.1);
  used.Restore(diagram.MakeContext());
  for (Simulator* sim : {&used, &fresh}) sim->AdvanceTo(0.07);
  EXPECT_EQ(used.Get(ramp.fired_), 1);
  EXPECT_TRUE(used.Snapshot() == fresh.Snapshot());
}

}  // namespace
}  // namespace pliant
