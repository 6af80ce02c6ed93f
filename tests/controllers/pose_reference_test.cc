#include "pliant/controllers/pose_reference.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

Pose At(const Vector3d& p, const Vector3d& turn = Vector3d::Zero()) {
  const double angle = turn.norm();
  return {p, angle == 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                        : Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix()};
}

/// Twist and acceleration are the rates of pose and twist: central differences, whose error is
/// h²/6 of the twist's third rate, the largest here, and ε/h of round-off.
template <class T>
void ExpectRatesToFit(const typename T::Options& options, double begin, double end,
                      double fourth_rate) {
  const double h = 1e-5, tolerance = fourth_rate * h * h / 6 + 1e-9;
  BlockTester<T> t(options);
  struct Sample {
    Pose pose;
    Twist twist, acceleration;
  };
  const auto at = [&](double time) {
    t.AdvanceTo(time);
    return Sample{t.Get(t->pose), t.Get(t->twist), t.Get(t->acceleration)};
  };
  for (int k = 0; k < 40; ++k) {
    const double time = begin + (end - begin) * (k + 0.5) / 40;
    const Sample a = at(time - h), b = at(time), c = at(time + h);
    const Vector3d v = (c.pose.position - a.pose.position) / (2 * h);
    const Eigen::AngleAxisd turn(c.pose.rotation * a.pose.rotation.transpose());
    const Vector3d w = turn.angle() * turn.axis() / (2 * h);
    EXPECT_LT((b.twist.tail(3) - v).norm(), tolerance) << time;
    EXPECT_LT((b.twist.head(3) - w).norm(), tolerance) << time;
    EXPECT_LT((b.acceleration - (c.twist - a.twist) / (2 * h)).norm(), tolerance) << time;
    EXPECT_NEAR(b.pose.rotation.determinant(), 1, 1e-14);
  }
}

const Vector3d kTurn{0.4, -0.8, 0.3};

PoseWaypoints::Options Way() {
  return {{{1, At({0.1, 0.2, 0.3})}, {2, At({0.4, 0.2, 0.1}, kTurn)}, {3, At({0, 0, 0}, -kTurn)}}};
}

TEST(PoseWaypoints, MovesAsItsTwistAndAccelerationSay) {
  // 360/T⁴ of the fifth power at most, times ‖[φ; d]‖
  ExpectRatesToFit<PoseWaypoints>(Way(), 0.5, 3.5, 360 * 2);
}

TEST(PoseWaypoints, RestsAtEachWaypointAndHasLeastJerkBetween) {
  BlockTester<PoseWaypoints> t(Way());
  for (const auto& [time, pose] : Way().waypoints) {
    t.AdvanceTo(time);
    EXPECT_LT((t.Get(t->pose).position - pose.position).norm(), 1e-15);
    EXPECT_LT((t.Get(t->pose).rotation - pose.rotation).norm(), 1e-14);
    EXPECT_LT(t.Get(t->twist).norm(), 1e-14);
    EXPECT_LT(t.Get(t->acceleration).norm(), 1e-13);
    if (time == 1) {
      t.AdvanceTo(1.5);  // halfway: the speed of least jerk is 15/8 of the mean
      EXPECT_LT((t.Get(t->twist).tail<3>() - 15.0 / 8 * Vector3d(0.3, 0, -0.2)).norm(), 1e-14);
      EXPECT_LT((t.Get(t->twist).head<3>() - 15.0 / 8 * kTurn).norm(), 1e-14);
    }
  }
  t.AdvanceTo(100);
  EXPECT_EQ(t.Get(t->pose).position.norm(), 0);
}

TEST(PoseSwing, MovesAsItsTwistAndAccelerationSay) {
  const PoseSwing::Options o{.start = At({0.1, 0, 0.5}, kTurn),
                             .way = {0, 0.2, 0.1},
                             .turn = {0.1, 0, 0.3},
                             .frequency_hz = 0.5,
                             .start_s = 0.25};
  ExpectRatesToFit<PoseSwing>(o, 0.3, 4, 0.5 * std::pow(std::numbers::pi, 4));
  BlockTester<PoseSwing> t(o);
  t.AdvanceTo(0.2);
  EXPECT_EQ(t.Get(t->pose).position, o.start.position);
  t.AdvanceTo(1.25);  // half a period behind the start
  EXPECT_LT((t.Get(t->pose).position - Vector3d(0.1, 0.2, 0.6)).norm(), 1e-15);
}

TEST(PoseCircle, MovesAsItsTwistAndAccelerationSay) {
  const PoseCircle::Options o{.start = At({0.5, 0.1, 0.4}, kTurn),
                              .center = {0.5, 0, 0.4},
                              .normal = {0, 0, 2},
                              .speed = -1.5,
                              .rise_s = 0.5,
                              .start_s = 0.25};
  ExpectRatesToFit<PoseCircle>(o, 0, 3, 100);
  BlockTester<PoseCircle> t(o);
  for (const double time : {0.1, 0.4, 1.0, 5.0}) {
    t.AdvanceTo(time);
    EXPECT_NEAR((t.Get(t->pose).position - o.center).norm(), 0.1, 1e-15);
    EXPECT_NEAR(t.Get(t->pose).position.z(), 0.4, 1e-15);
  }
  EXPECT_NEAR(t.Get(t->twist).norm(), 0.15, 1e-15);  // ω r, once it has risen
  // clockwise seen from above: from +y towards +x
  t.AdvanceTo(5);
  const Vector3d out = t.Get(t->pose).position - o.center, v = t.Get(t->twist).tail<3>();
  EXPECT_LT(out.cross(v).z(), 0);
}

TEST(PoseReferences, RefuseWhatIsNoMotion) {
  const auto waypoints = [](std::vector<PoseWaypoints::Waypoint> all) {
    return ErrorOf([&] { PoseWaypoints block({all}); });
  };
  EXPECT_EQ(waypoints({}), "waypoints must have at least one");
  EXPECT_EQ(waypoints({{1, At({0, 0, 0})}, {1, At({1, 0, 0})}}),
            "waypoints are in order of time: behind 1 s, got 1 s");
  EXPECT_EQ(waypoints({{1, At({0, 0, 0})}, {2, At({0, 0, 0}, {std::numbers::pi, 0, 0})}}),
            "neighbouring waypoints are less than half a turn apart, got 3.141592654 rad");
  EXPECT_EQ(
      ErrorOf([] { PoseSwing block({.start = {}, .way = {}, .turn = {}, .frequency_hz = 0}); }),
      "frequency_hz must be > 0 Hz, got 0");
  EXPECT_EQ(ErrorOf([] {
              PoseCircle block(
                  {.start = At({1, 0, 1}), .center = {0, 0, 0}, .normal = {0, 0, 1}, .speed = 1});
            }),
            "normal must be perpendicular to the way from center to start, 1 0 1, got 0 0 1");
}

}  // namespace
}  // namespace pliant
