#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/delay.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

// shown: begin tick
/// Counts its ticks: y_k = y_{k−1} + 1.
class Ticks final : public Block {
 public:
  Ticks() {
    Every(10ms).Compute(count).From(count).As([](double before) { return before + 1; });
  }
  Output<double> count{this, "count"};
};

TEST(Time, ARowOfALogIsOneInstant) {
  DiagramBuilder b;
  auto& ticks = b.Add<Ticks>("ticks");
  auto& delay = b.Add<Delay<double>>("delay", {.period = 10ms});
  auto& logger = b.Add<Logger>("logger", {.period = 10ms});
  b.Connect(ticks.count, delay.u);
  b.Connect(ticks.count, logger.in);
  b.Connect(delay.y, logger.in);
  const Diagram diagram = b.Build();

  Simulator sim{diagram};
  sim.AdvanceTo(0.03);  // not through the tick at 0.03 s
  const Log& log = sim.Get(logger.log);
  EXPECT_EQ(log["ticks.count"], Eigen::Vector3d(1, 2, 3));  // held outputs are new,
  EXPECT_EQ(log["delay.y"], Eigen::Vector3d(0, 1, 2));      // states are those before
}
// shown: end tick

// shown: begin event
/// A ball that falls and bounces: ḧ = −g;  at h = 0: ḣ⁺ = −ḣ⁻.
class Ball final : public Block {
 public:
  Ball() {
    Derivative(h).From(v).As([](double rate) { return rate; });
    Derivative(v).From().As([] { return -9.81; });
    Compute(height).From(h).As([](double x) { return x; });
    When(height)
        .Crosses(Direction::Falling)
        .Update(v, bounced)
        .From(v, clock)
        .As([](double rate, double t) { return std::tuple(-rate, t); });
  }
  Continuous<double> h{this, "h", {}, 1.0}, v{this, "v"};
  Discrete<double> bounced{this, "bounced"};
  Output<double> height{this, "height"};
};

TEST(Time, AnEventIsWhereTheStateSaysNotWhereAStepEnds) {
  DiagramBuilder b;
  auto& ball = b.Add<Ball>("ball");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.5);
  EXPECT_NEAR(sim.Get(ball.bounced), std::sqrt(2 / 9.81), 1e-9);  // the integrator's tolerance
}
// shown: end event

// shown: begin snapshot
TEST(Time, ARunThatIsPutBackIsTheSameRun) {
  DiagramBuilder b;
  auto& ball = b.Add<Ball>("ball");
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(0.3);
  const Context then = sim.Snapshot();
  sim.AdvanceTo(1);
  const double height = sim.Get(ball.height);
  sim.Restore(then);
  sim.AdvanceTo(1);
  EXPECT_EQ(sim.Get(ball.height), height);  // bit for bit
}
// shown: end snapshot

}  // namespace
}  // namespace pliant
