#include "pliant/plants/hardware_wrench.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// A sensor that a test speaks for.
class Told final : public WrenchSource {
 public:
  bool Read(WrenchReading& newest) noexcept override {
    newest.link = link;
    if (!next) return false;
    newest = *next;
    newest.link = link;
    if (!repeats) next.reset();
    return true;
  }
  void Say(const Wrench& wrench, std::uint32_t status = 0, bool faulty = false) {
    next = WrenchReading{wrench, ++sequence, status, faulty, {}};
  }

  std::optional<WrenchReading> next;
  std::uint32_t sequence = 0;
  LinkCounts link;
  bool repeats = false;  // the same again and again
};

const Wrench kPull{0.1, 0.2, 0.3, 4, 5, 6};

struct Sensor {
  explicit Sensor(HardwareWrench::Options o = {})
      : t([&] {
          o.source = source;
          o.frame = "wrist";
          return o;
        }()) {}
  bool Tick() {
    t.Tick();
    return t.Get(t->valid);
  }
  Wrench wrench() { return t.Get(t->wrench); }
  WrenchStatus status() { return t.Get(t->status); }

  std::shared_ptr<Told> source = std::make_shared<Told>();
  BlockTester<HardwareWrench> t;
};

TEST(HardwareWrench, IsNotValidBeforeTheFirstMeasurement) {
  Sensor sensor;
  for (int k = 0; k < 20; ++k) {
    EXPECT_FALSE(sensor.Tick());
    EXPECT_EQ(sensor.wrench(), Wrench());
  }
  sensor.source->Say(kPull);
  EXPECT_TRUE(sensor.Tick());
  EXPECT_EQ(sensor.wrench(), kPull);
}

TEST(HardwareWrench, IsStaleAfterExactlyAsManyTicksAsAreAskedFor) {
  for (const int n : {1, 2, 10, 25}) {
    Sensor sensor({.stale_after = std::chrono::milliseconds(n)});
    for (int round = 0; round < 3; ++round) {
      sensor.source->Say(kPull);
      ASSERT_TRUE(sensor.Tick());
      for (int k = 1; k < n; ++k) ASSERT_TRUE(sensor.Tick()) << k << " of " << n;
      for (int k = n; k < n + 5; ++k) {
        ASSERT_FALSE(sensor.Tick()) << k << " of " << n;
        ASSERT_EQ(sensor.wrench(), kPull) << "held";
        ASSERT_DOUBLE_EQ(sensor.status().age, k * 1e-3);
      }
    }
  }
}

TEST(HardwareWrench, RoundsUpToWholeTicks) {
  Sensor sensor({.period = 2ms, .stale_after = 5ms});
  sensor.source->Say(kPull);
  EXPECT_TRUE(sensor.Tick());
  EXPECT_TRUE(sensor.Tick());
  EXPECT_TRUE(sensor.Tick());
  EXPECT_FALSE(sensor.Tick());
  // 30 Hz is no whole number of nanoseconds.
  Sensor slow({.period = Hertz(30), .stale_after = Hertz(10)});
  slow.source->Say(kPull);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(slow.Tick());
  EXPECT_FALSE(slow.Tick());
}

TEST(HardwareWrench, TakesASensorThatRepeatsItselfForStale) {
  Sensor sensor({.stale_after = 4ms});
  sensor.source->Say(kPull);
  sensor.source->repeats = true;
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(sensor.Tick());
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(sensor.Tick());
  sensor.source->Say(2 * kPull);
  EXPECT_TRUE(sensor.Tick());
  EXPECT_EQ(sensor.wrench(), Wrench(2 * kPull));
}

TEST(HardwareWrench, AMeasurementThatIsNoneIsNotValidAndNotShown) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const Wrench& bad : {Wrench{nan, 0, 0, 0, 0, 0}, Wrench{0, 0, 0, 0, 0, -inf},
                            Wrench{15.01, 0, 0, 0, 0, 0}, Wrench{0, 0, 0, 0, 0, -1201}}) {
    Sensor sensor({.range = {15, 15, 12, 500, 500, 1200}});
    sensor.source->Say(kPull);
    EXPECT_TRUE(sensor.Tick());
    sensor.source->Say(bad);
    for (int k = 0; k < 3; ++k) {
      EXPECT_FALSE(sensor.Tick()) << "until there is a good one";
      EXPECT_EQ(sensor.wrench(), kPull);
      EXPECT_DOUBLE_EQ(sensor.status().age, (k + 1) * 1e-3);
    }
    sensor.source->Say({15, 0, 0, 0, 0, -1200});
    EXPECT_TRUE(sensor.Tick()) << "at the end of the range";
  }
}

TEST(HardwareWrench, BelievesASensorThatSaysItIsFaulty) {
  Sensor sensor;
  sensor.source->Say(kPull, 4, true);
  EXPECT_FALSE(sensor.Tick());
  EXPECT_EQ(sensor.status().device, 4U);
  sensor.source->Say(kPull, 1, false);
  EXPECT_TRUE(sensor.Tick());
  EXPECT_EQ(sensor.status().device, 1U);
}

TEST(HardwareWrench, TellsWhatTheLinkCounts) {
  Sensor sensor;
  sensor.source->link = {.lost = 1, .corrupted = 2, .out_of_order = 3, .duplicated = 4};
  sensor.Tick();
  EXPECT_EQ(sensor.status().link, sensor.source->link);
}

// The sensor is turned by a quarter about z, and shows what the robot does to the environment.
TEST(HardwareWrench, IsOfTheEnvironmentOnTheRobotInTheAxesOfTheFrame) {
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Wrench bias{1, 2, 3, 4, 5, 6};
  Sensor sensor({.bias = bias, .axes = R, .sign = -1});
  sensor.source->Say({10, 20, 30, 40, 50, 60});
  sensor.Tick();
  const Wrench expected = Wrench{20, -10, -30, 50, -40, -60} - bias;
  EXPECT_LT((sensor.wrench() - expected).norm(), 1e-14 * 100);
}

TEST(HardwareWrench, WithoutASourceIsNeverValid) {
  BlockTester<HardwareWrench> t({.frame = "wrist"});
  for (int k = 0; k < 3; ++k) {
    t.Tick();
    EXPECT_FALSE(t.Get(t->valid));
    EXPECT_EQ(t.Get(t->wrench), Wrench());
  }
  EXPECT_EQ(t.Get(t->status).link, LinkCounts());
}

TEST(HardwareWrench, TakesNothingFromTheHeap) {
  Sensor sensor;
  sensor.source->repeats = true;
  sensor.Tick();
  const long before = Allocations();
  for (int k = 0; k < 100; ++k) {
    sensor.source->Say(kPull);
    sensor.Tick();
  }
  EXPECT_EQ(Allocations() - before, 0);
}

TEST(HardwareWrench, RefusesOptionsThatAreNone) {
  const auto error = [](HardwareWrench::Options o) {
    return ErrorOf([&] { HardwareWrench wrench(o); });
  };
  EXPECT_EQ(error({.period = 0ms}), "a period must be > 0, got 0 s");
  EXPECT_EQ(error({.stale_after = 0ms}),
            "stale_after must be > 0, and 10⁶ periods at most, got 0 s");
  EXPECT_EQ(error({.bias = {0, 0, std::nan(""), 0, 0, 0}}), "bias[mz] must be finite N·m, got nan");
  EXPECT_EQ(error({.range = {0, 0, 0, -1, 0, 0}}), "range[fx] must be >= 0 N, got -1");
  EXPECT_EQ(error({.sign = 2}), "sign must be 1 or -1, got 2");
  EXPECT_EQ(error({.axes = -Eigen::Matrix3d::Identity()}),
            "axes must be a rotation: R Rᵀ = I, det R = 1, got\n-1 -0 -0\n-0 -1 -0\n-0 -0 -1");
}

}  // namespace
}  // namespace pliant
