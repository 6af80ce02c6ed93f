#include "pliant/controllers/path_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/joint_reference.h"
#include "pliant/controllers/pose_reference.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

PathPhase::Options Options() {
  return {.size = 3, .free = 0.1, .stop = 0.5, .lag_s = 0.05, .period = 1ms};
}

TEST(PathPhase, IsTheTimeToTheBitWhereNothingDeviates) {
  BlockTester<PathPhase> t(Options());
  t.Set(t->error, Eigen::Vector3d(0.1, 0, 0));
  for (const double time : {0.0, 0.0123, 1.0 / 3, 7.7}) {
    t.AdvanceTo(time);
    const PathTime phase = t.Get(t->phase);
    EXPECT_EQ(phase.phase, t.time());
    EXPECT_EQ(phase.rate, 1);
    EXPECT_EQ(phase.acceleration, 0);
    EXPECT_FALSE(phase.by_clock);
  }
}

TEST(PathPhase, StandsStillUnderALargeDeviationAndGoesOnBehindIt) {
  BlockTester<PathPhase> t(Options());
  t.Set(t->error, Eigen::Vector3d::Zero());
  t.AdvanceTo(1);
  t.Set(t->error, Eigen::Vector3d(0, 0.6, 0));
  t.AdvanceTo(1.5);
  const double gone = std::exp(-0.5 / 0.05);
  EXPECT_NEAR(t.Get(t->phase).rate, gone, 1e-14);
  EXPECT_NEAR(t.Get(t->phase).phase, 1 + 0.05 * (1 - gone), 1e-13);  // ∫ of e^{−t/T}
  t.AdvanceTo(10);
  EXPECT_NEAR(t.Get(t->phase).phase, 1.05, 1e-13);
  t.Set(t->error, Eigen::Vector3d::Zero());
  t.AdvanceTo(12);
  EXPECT_NEAR(t.Get(t->phase).rate, 1, 1e-13);  // round-off of 2000 ticks
  EXPECT_NEAR(t.Get(t->phase).phase, 1.05 + 2 - 0.05, 1e-12);
}

TEST(PathPhase, NeverRunsBackwardsAndHasTheRatesItSays) {
  BlockTester<PathPhase> t(Options());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> draw(0, 0.8);
  double last = 0;
  for (int k = 1; k < 3000; ++k) {
    t.Set(t->error, Eigen::Vector3d(draw(random), 0, 0));
    const double tick = 1e-3 * k, h = 1e-5;
    PathTime x[3];
    for (int i = 0; i < 3; ++i) {
      t.AdvanceTo(tick + 5e-4 + (i - 1) * h);
      x[i] = t.Get(t->phase);
    }
    ASSERT_GE(x[1].phase, last);
    last = x[1].phase;
    ASSERT_GE(x[1].rate, 0);
    ASSERT_LE(x[1].rate, 1);
    ASSERT_LE(std::abs(x[1].acceleration), 1 / 0.05);
    // h² of the third rate 1/T², and ε/h
    ASSERT_NEAR(x[1].rate, (x[2].phase - x[0].phase) / (2 * h), 1e-8);
    ASSERT_NEAR(x[1].acceleration, (x[2].rate - x[0].rate) / (2 * h), 1e-6);
  }
}

TEST(PathPhase, SlowsHalfWayToHalf) {
  BlockTester<PathPhase> t(Options());
  t.Set(t->error, Eigen::Vector3d(0.3, 0, 0));  // between e₀ and e₁
  t.AdvanceTo(5);
  EXPECT_NEAR(t.Get(t->phase).rate, 0.5, 1e-14);
}

// The frame does not move: a reference at 0.1 m/s leaves it, and what is left of its rate at e₁
// takes it no further than 0.1 m/s · T.
TEST(PathPhase, KeepsAReferenceNearAFrameThatDoesNotFollow) {
  const RobotModel m = Gen3();
  const JointPosition q{0.2, 0.5, 0.1, -1.5, 0.3, -0.5, 0.2};
  RobotDynamics d(m, {"tool_frame"});
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  Pose goal = d.frame[0].pose;
  goal.position.x() += 10;
  DiagramBuilder b;
  auto& state = b.Add<Constant<RobotDynamics>>("state", {.space = m.joints(), .value = d});
  auto& reference = b.Add<PoseWaypoints>(
      "reference", {.waypoints = {{0, d.frame[0].pose}, {187.5, goal}}});  // 15/8 · 10 m at most
  auto& task = b.Add<FrameTask>("task", {.model = m,
                                         .frame = "tool_frame",
                                         .part = FrameTask::Part::Position,
                                         .stiffness = TaskVector::Ones(3),
                                         .damping = TaskVector::Ones(3)});
  auto& phase = b.Add<PathPhase>("phase", Options());
  b.Connect(state.y, task.dynamics);
  b.Connect(reference.pose, task.target);
  b.Connect(task.error, phase.error);
  b.Connect(phase.phase, reference.phase);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  sim.AdvanceTo(100);
  EXPECT_GT(sim.Get(task.error).norm(), 0.1);
  EXPECT_LT(sim.Get(task.error).norm(), 0.5 + 0.1 * 0.05);
  EXPECT_LT(sim.Get(phase.phase).rate, 0.1);
  EXPECT_LT(sim.Get(reference.twist).norm(), 0.1 * 0.1);
}

TEST(PathPhase, HoldsTheLaws) {
  BlockTester<PathPhase> t(Options());
  t.Set(t->error, Eigen::Vector3d::Zero());
  ExpectBlockLaws(std::move(t));
}

TEST(PathPhase, RefusesOptionsThatMakeNone) {
  const auto error = [](auto change) {
    PathPhase::Options o = Options();
    change(o);
    return ErrorOf([&] { PathPhase block(o); });
  };
  using O = PathPhase::Options;
  EXPECT_EQ(error([](O& o) { o.stop = 0.1; }), "stop must be > free, 0.1, got 0.1");
  EXPECT_EQ(error([](O& o) { o.lag_s = 0; }), "lag_s must be > 0 s, got 0");
  EXPECT_EQ(error([](O& o) { o.size = 7; }), "size must be from 1 to 6, got 7");
  O o;
  EXPECT_EQ(ErrorOf([&] { ParameterFile::ReadText("free: 0.1").Fill(o); }),
            "YAML:1:1: 'stop' is missing");
}

const Joints kJoints{"shoulder", "elbow"};

template <class T>
void ExpectRatesToFit(const typename T::Options& options) {
  const double h = 1e-5, b = 0.5, c = 0.3;
  for (const bool by_clock : {true, false}) {
    BlockTester<T> t(options);
    const auto at = [&](double time) {
      if (by_clock)
        t.AdvanceTo(time);
      else
        t.Set(t->phase, PathTime{b * time + 0.5 * c * time * time, b + c * time, c, false});
      return JointMotion{t.Get(t->position), t.Get(t->velocity), t.Get(t->acceleration)};
    };
    for (int k = 0; k < 30; ++k) {
      const double time = 0.1 * k + 0.013;
      const JointMotion x = at(time - h), y = at(time), z = at(time + h);
      ASSERT_LT((y.velocity - (z.position - x.position) / (2 * h)).norm(), 1e-6) << time;
      ASSERT_LT((y.acceleration - (z.velocity - x.velocity) / (2 * h)).norm(), 1e-6) << time;
    }
  }
}

JointWaypoints::Options Way() {
  return {.joints = kJoints, .waypoints = {{0.5, {0, 1}}, {1, {2, 1}}, {2, {-1, 0.5}}}};
}

TEST(JointWaypoints, HasTheRatesItSays) { ExpectRatesToFit<JointWaypoints>(Way()); }

TEST(JointWaypoints, RestsAtItsWaypoints) {
  BlockTester<JointWaypoints> t(Way());
  EXPECT_EQ(t.Get(t->position), (JointPosition{0, 1}));
  for (const auto& [time, position] : Way().waypoints) {
    t.AdvanceTo(time);
    EXPECT_LT((t.Get(t->position) - position).norm(), 1e-14);
    EXPECT_LT(t.Get(t->velocity).norm(), 1e-13);
  }
}

TEST(JointSwing, HasTheRatesItSaysAndReachesTheFarEnd) {
  const JointSwing::Options o{
      .joints = kJoints, .start = {0.1, 0.2}, .way = Eigen::Vector2d(1, -2), .frequency_hz = 0.5};
  ExpectRatesToFit<JointSwing>(o);
  BlockTester<JointSwing> t(o);
  t.AdvanceTo(1);
  EXPECT_LT((t.Get(t->position) - Eigen::Vector2d(1.1, -1.8)).norm(), 1e-15);
}

TEST(JointReferences, RefuseWhatIsNoMotion) {
  const auto waypoints = [](std::vector<JointWaypoints::Waypoint> all) {
    return ErrorOf([&] { JointWaypoints block({.joints = kJoints, .waypoints = all}); });
  };
  EXPECT_EQ(waypoints({}), "waypoints must have at least one");
  EXPECT_EQ(waypoints({{1, {0, 1}}, {1, {0, 1}}}),
            "waypoints are in order of time: behind 1 s, got 1 s");
  EXPECT_EQ(waypoints({{1, {0, 1}}, {2, {0, 1, 2}}}),
            "position has an element for each of the 2 joints, got 3");
  EXPECT_EQ(
      ErrorOf([] {
        JointSwing block(
            {.joints = kJoints, .start = {0, 0}, .way = Eigen::Vector2d(1, 1), .frequency_hz = 0});
      }),
      "frequency_hz must be > 0 Hz, got 0");
  JointWaypoints::Options o;
  ParameterFile::ReadText("waypoints: [{time_s: 1, position: [1, 2]}]").Fill(o);
  EXPECT_EQ(o.waypoints[0].position, (JointPosition{1, 2}));
}

}  // namespace
}  // namespace pliant
