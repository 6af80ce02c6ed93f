#include "pliant/systems/trajectory_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pliant/systems/simulator.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

const Joints kTwo{"shoulder", "elbow"};
constexpr Interpolation kAll[] = {Interpolation::Hold, Interpolation::Linear, Interpolation::Cubic,
                                  Interpolation::Monotone};
const std::vector<double> kTimes{0.2, 0.5, 1, 1.1, 2};

/// Rows of f at the times; the elbow is its mirror image.
JointTrajectory Rows(const std::function<double(double)>& f,
                     const std::vector<double>& times = kTimes) {
  JointTrajectory t{.joints = kTwo, .times = times, .positions = {}};
  for (const double x : times) t.positions.push_back({f(x), -f(x)});
  return t;
}

double Bumps(double t) { return std::sin(5 * t) + t * t; }

struct Point {
  double q, v, a;
};

/// Reads the shoulder at any time.
class Player {
 public:
  explicit Player(const TrajectorySource::Options& o) : t_(o) {}
  Point At(double time) {
    if (time > t_.time()) t_.AdvanceTo(time);
    const Point p{t_.Get(t_->position)(0), t_.Get(t_->velocity)(0), t_.Get(t_->acceleration)(0)};
    EXPECT_EQ(t_.Get(t_->position)(1), -p.q);
    return p;
  }

 private:
  BlockTester<TrajectorySource> t_;
};

TEST(TrajectorySource, GoesThroughItsRowsAndRestsBeyond) {
  for (const Interpolation how : kAll) {
    Player player({.trajectory = Rows(Bumps), .interpolation = how});
    EXPECT_EQ(player.At(0.1).q, Bumps(0.2));
    EXPECT_EQ(player.At(0.1).v, 0);
    for (const double t : kTimes) EXPECT_NEAR(player.At(t).q, Bumps(t), 1e-15) << Words(how)[0];
    const Point end = player.At(3);
    EXPECT_EQ(end.q, Bumps(2));
    EXPECT_EQ(end.v, 0);
    EXPECT_EQ(end.a, 0);
  }
}

TEST(TrajectorySource, HoldsOrGoesStraight) {
  Player hold({.trajectory = Rows(Bumps), .interpolation = Interpolation::Hold});
  EXPECT_EQ(hold.At(0.49).q, Bumps(0.2));
  EXPECT_EQ(hold.At(0.5).q, Bumps(0.5));
  Player linear({.trajectory = Rows([](double t) { return 3 * t - 1; })});
  for (const double t : {0.25, 0.7, 1.9}) {
    EXPECT_NEAR(linear.At(t).q, 3 * t - 1, 1e-14);
    EXPECT_NEAR(linear.At(t).v, 3, 1e-14);
    EXPECT_EQ(linear.At(t).a, 0);
  }
}

TEST(TrajectorySource, OfAStraightLineIsExact) {
  for (const Interpolation how : {Interpolation::Cubic, Interpolation::Monotone}) {
    Player line({.trajectory = Rows([](double t) { return 2 - 7 * t; }), .interpolation = how});
    for (const double t : {0.3, 0.77, 1.05, 1.7}) {
      EXPECT_NEAR(line.At(t).q, 2 - 7 * t, 1e-13);
      EXPECT_NEAR(line.At(t).v, -7, 1e-12);
      EXPECT_NEAR(line.At(t).a, 0, 1e-11);
    }
  }
}

/// Derivatives agree with differences of what is shown, and do not jump at rows where they must
/// not.
TEST(TrajectorySource, VelocityAndAccelerationAreDerivatives) {
  for (const Interpolation how : {Interpolation::Cubic, Interpolation::Monotone}) {
    const auto at = [&](double t) {
      return Player({.trajectory = Rows(Bumps), .interpolation = how}).At(t);
    };
    const double h = 1e-5;
    for (const double t : {0.3, 0.8, 1.05, 1.5}) {
      // Differences are good to h² times the third derivative, below 10³, and ε/h.
      EXPECT_NEAR(at(t).v, (at(t + h).q - at(t - h).q) / (2 * h), 1e-6);
      EXPECT_NEAR(at(t).a, (at(t + h).v - at(t - h).v) / (2 * h), 1e-6);
    }
    for (const double row : {0.5, 1.0, 1.1}) {
      EXPECT_NEAR(at(row - 1e-9).v, at(row).v, 1e-6);
      if (how == Interpolation::Cubic) {
        EXPECT_NEAR(at(row - 1e-9).a, at(row).a, 1e-5);
      }
    }
    if (how == Interpolation::Cubic) {
      EXPECT_NEAR(at(0.2).a, 0, 1e-12) << "natural";
      EXPECT_NEAR(at(2 - 1e-9).a, 0, 1e-6);
    }
  }
}

// The error of the natural spline inside falls with h⁴.
TEST(TrajectorySource, ACubicConvergesWithTheFourthOrder) {
  const auto f = [](double t) { return std::sin(2 * t); };
  const auto error = [&](int n) {
    std::vector<double> times;
    for (int i = 0; i <= n; ++i) times.push_back(3.0 * i / n);
    Player player({.trajectory = Rows(f, times), .interpolation = Interpolation::Cubic});
    double worst = 0;
    for (int i = 0; i < 100; ++i) {
      const double t = 1 + 0.01 * i + 0.003;
      worst = std::max(worst, std::abs(player.At(t).q - f(t)));
    }
    return worst;
  };
  EXPECT_NEAR(std::log2(error(32) / error(64)), 4, 0.3);
}

TEST(TrajectorySource, MonotoneDoesNotOvershoot) {
  const JointTrajectory steps = Rows([](double t) {
    return t < 0.9 ? 0.0 : t < 1.05 ? 1.0 : 1.001;
  });
  Player monotone({.trajectory = steps, .interpolation = Interpolation::Monotone});
  Player cubic({.trajectory = steps, .interpolation = Interpolation::Cubic});
  double before = 0, most = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.2 + 1.8e-3 * i;
    const double q = monotone.At(t).q;
    EXPECT_GE(q, before - 1e-15);
    before = q;
    most = std::max(most, cubic.At(t).q);
  }
  EXPECT_GT(most, 1.002) << "a spline does";
}

TEST(TrajectorySource, BeginsWhenItIsToldTo) {
  Player player({.trajectory = Rows([](double t) { return t; }), .start_s = 10});
  EXPECT_NEAR(player.At(10.7).q, 0.7, 1e-14);
}

TEST(TrajectorySource, MayEndTheRun) {
  DiagramBuilder b;
  b.Add<TrajectorySource>("way", {.trajectory = Rows(Bumps), .end = TrajectoryEnd::Stop});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(10);
  ASSERT_TRUE(sim.ended());
  EXPECT_NEAR(sim.time(), 2, 1e-15);
  EXPECT_EQ(sim.ended()->block, "way");
  EXPECT_EQ(sim.ended()->reason, "the trajectory is over");
}

TEST(TrajectorySource, OfOneRowStands) {
  for (const Interpolation how : kAll) {
    Player player({.trajectory = Rows(Bumps, {0.5}), .interpolation = how});
    EXPECT_EQ(player.At(0.2).q, Bumps(0.5));
    EXPECT_EQ(player.At(0.7).q, Bumps(0.5));
  }
  for (const Interpolation how : {Interpolation::Cubic, Interpolation::Monotone}) {
    Player two({.trajectory = Rows([](double t) { return t; }, {0, 1}), .interpolation = how});
    EXPECT_NEAR(two.At(0.3).q, 0.3, 1e-15);
    EXPECT_NEAR(two.At(0.3).v, 1, 1e-15);
  }
}

TEST(TrajectorySource, KeepsTheLawsOfBlocks) {
  for (const Interpolation how : kAll)
    ExpectBlockLaws(
        BlockTester<TrajectorySource>({.trajectory = Rows(Bumps), .interpolation = how}));
}

TEST(TrajectorySource, RefusesWhatCannotBePlayed) {
  EXPECT_EQ(ErrorOf([] {
              BlockTester<TrajectorySource>(
                  {.trajectory = {.joints = kTwo, .times = {}, .positions = {}}});
            }),
            "block: a trajectory must have a row");
  EXPECT_EQ(ErrorOf([] {
              BlockTester<TrajectorySource>(
                  {.trajectory = Rows(Bumps), .end = TrajectoryEnd::Stop, .start_s = -3});
            }),
            "block: a run cannot end before it begins: start_s and the last time of the trajectory "
            "must add up to more than 0, got -1");
  EXPECT_EQ(
      ErrorOf([] { BlockTester<TrajectorySource>({.trajectory = Rows(Bumps), .start_s = NAN}); }),
      "block: start_s must be finite, got nan");
}

}  // namespace
}  // namespace pliant
