#include "pliant/controllers/pose_reference.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "pliant/plants/parameter_file.h"
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

TEST(PoseWaypoints, GoThroughTheirLapsAsThroughTheFirst) {
  PoseWaypoints::Options way{
      .waypoints = {{1, At({0, 0, 0})}, {2, At({0.3, 0, 0})}, {3.5, At({0, 0, 0})}}, .laps = 3};
  BlockTester<PoseWaypoints> laps(way);
  way.laps = 1;
  for (const int lap : {0, 1, 2}) {
    BlockTester<PoseWaypoints> once(way);
    for (const double t : {1.25, 2.0, 3.1}) {
      once.AdvanceTo(t);
      laps.AdvanceTo(t + 2.5 * lap);
      EXPECT_LT((laps.Get(laps->pose).position - once.Get(once->pose).position).norm(), 1e-14);
      EXPECT_LT((laps.Get(laps->twist) - once.Get(once->twist)).norm(), 1e-13);
    }
  }
  laps.AdvanceTo(9);
  EXPECT_EQ(laps.Get(laps->pose).position.norm(), 0);
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

PoseTable::Options Rows() {
  std::vector<TimedPose> rows;
  for (const double t : {1.0, 1.3, 1.5, 2.0, 2.2, 3.0})
    rows.push_back({t, At({std::sin(3 * t), std::cos(2 * t), t * t}, t * kTurn)});
  return {rows};
}

TEST(PoseTable, MovesAsItsTwistAndAccelerationSay) {
  // 360/T⁴ of the fifth power, T = 0.2 s, times ‖[φ; d]‖
  ExpectRatesToFit<PoseTable>(Rows(), 0.5, 3.5, 360 / std::pow(0.2, 4) * 1.5);
}

TEST(PoseTable, PassesThroughItsRowsAndRestsAtItsEnds) {
  BlockTester<PoseTable> t(Rows());
  for (const auto& [time, pose] : Rows().rows) {
    t.AdvanceTo(time);
    EXPECT_LT((t.Get(t->pose).position - pose.position).norm(), 1e-14) << time;
    EXPECT_LT((t.Get(t->pose).rotation - pose.rotation).norm(), 1e-14) << time;
    if (time != 1 && time != 3) continue;
    EXPECT_LT(t.Get(t->twist).norm(), 1e-11);
    EXPECT_LT(t.Get(t->acceleration).norm(), 1e-10);
  }
}

TEST(PoseTable, IsTwiceContinuouslyDifferentiable) {
  for (const auto& [time, pose] : Rows().rows) {
    BlockTester<PoseTable> t(Rows());
    t.AdvanceTo(time - 1e-9);
    const Twist v = t.Get(t->twist), a = t.Get(t->acceleration);
    t.AdvanceTo(time + 1e-9);
    EXPECT_LT((t.Get(t->twist) - v).norm(), 2e-9 * 1e3) << time;
    EXPECT_LT((t.Get(t->acceleration) - a).norm(), 2e-9 * 1e4) << time;
  }
}

TEST(PoseTable, FollowsAParabolaExactlyInside) {
  std::vector<TimedPose> rows;
  for (const double t : {0.0, 0.5, 0.8, 1.5, 2.0, 2.1})
    rows.push_back({t, At(Vector3d(1, -2, 0.5) * t * t + Vector3d(0.3, 0, 1) * t)});
  BlockTester<PoseTable> t(PoseTable::Options{rows});
  for (const double time : {0.6, 0.9, 1.4, 1.8}) {
    t.AdvanceTo(time);
    const Vector3d p = Vector3d(1, -2, 0.5) * time * time + Vector3d(0.3, 0, 1) * time;
    EXPECT_LT((t.Get(t->pose).position - p).norm(), 1e-14) << time;
    EXPECT_LT((t.Get(t->acceleration).tail<3>() - 2 * Vector3d(1, -2, 0.5)).norm(), 1e-12);
  }
}

/// With a phase that runs φ = a + b t + c t²/2, all rates are those with respect to time.
template <class T>
void ExpectThePhaseToLead(const typename T::Options& options) {
  const double h = 1e-5, a = 0.2, b = 0.5, c = 0.3;
  BlockTester<T> t(options);
  const auto show = [&](double time) {
    t.Set(t->phase, PathTime{a + b * time + 0.5 * c * time * time, b + c * time, c, false});
  };
  for (int k = 0; k < 20; ++k) {
    const double time = 0.15 * k + 0.01;
    show(time - h);
    const Pose before = t.Get(t->pose);
    const Twist v_before = t.Get(t->twist);
    show(time + h);
    const Pose after = t.Get(t->pose);
    const Twist v_after = t.Get(t->twist);
    show(time);
    const Vector3d v = (after.position - before.position) / (2 * h);
    const Eigen::AngleAxisd turn(after.rotation * before.rotation.transpose());
    EXPECT_LT((t.Get(t->twist).tail(3) - v).norm(), 2e-6) << time;  // h² and ε/h, as above
    EXPECT_LT((t.Get(t->twist).head(3) - turn.angle() * turn.axis() / (2 * h)).norm(), 2e-6);
    EXPECT_LT((t.Get(t->acceleration) - (v_after - v_before) / (2 * h)).norm(), 2e-6) << time;
  }
}

TEST(PoseReferences, FollowAPhaseByTheChainRule) {
  ExpectThePhaseToLead<PoseWaypoints>(Way());
  ExpectThePhaseToLead<PoseTable>(Rows());
  ExpectThePhaseToLead<PoseSwing>({.start = At({0.1, 0, 0.5}, kTurn),
                                   .way = {0, 0.2, 0.1},
                                   .turn = {0.1, 0, 0.3},
                                   .frequency_hz = 0.5});
  ExpectThePhaseToLead<PoseCircle>({.start = At({0.5, 0.1, 0.4}, kTurn),
                                    .center = {0.5, 0, 0.4},
                                    .normal = {0, 0, 2},
                                    .speed = -1.5});
}

TEST(PoseReferences, AreReadFromAFile) {
  const auto file = [](const std::string& text) { return ParameterFile::ReadText(text); };
  PoseTable::Options table;
  file("rows: [{time_s: 0}, {time_s: 500 ms, position: [1, 2, 3]}]").Fill(table);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[1].time_s, 0.5);
  EXPECT_EQ(table.rows[1].pose.position, Vector3d(1, 2, 3));
  EXPECT_EQ(table.rows[1].pose.rotation, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  EXPECT_EQ(ErrorOf([&] { file("rows: [{position: [1, 2, 3]}]").Fill(table); }),
            "YAML:1:8: 'time_s' is missing");
  PoseWaypoints::Options waypoints;
  file("waypoints: [{time_s: 1, rotation: [[0, -1, 0], [1, 0, 0], [0, 0, 1]]}]").Fill(waypoints);
  EXPECT_EQ(waypoints.waypoints[0].pose.rotation(1, 0), 1);
  PoseCircle::Options circle;
  file("{center: [0, 0, 1], normal: [0, 0, 1], speed: 30 deg/s}").Fill(circle);
  EXPECT_NEAR(circle.speed, std::numbers::pi / 6, 1e-15);
  EXPECT_EQ(ErrorOf([&] {
              PoseCircle::Options none;
              file("{center: [0, 0, 1], speed: 1}").Fill(none);
            }),
            "YAML:1:1: 'normal' is missing");
  PoseSwing::Options swing;
  file("{way: [0.1, 0, 0], frequency_hz: 2}").Fill(swing);
  EXPECT_EQ(swing.way.x(), 0.1);
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
      ErrorOf([] {
        PoseWaypoints block({.waypoints = {{1, At({0, 0, 0})}, {2, At({1, 0, 0})}}, .laps = 2});
      }),
      "with laps the last waypoint must be at the pose of the first, and later");
  EXPECT_EQ(ErrorOf([] {
              PoseWaypoints block({.waypoints = {{1, At({0, 0, 0})}}, .laps = 0});
            }),
            "laps must be from 1 to 100000, got 0");
  const auto table = [](std::vector<TimedPose> all) {
    return ErrorOf([&] { PoseTable block({all}); });
  };
  EXPECT_EQ(table({}), "rows must have at least one");
  EXPECT_EQ(table({{1, At({0, 0, 0})}, {2, At({0, 0, 0}, {2, 0, 0})}}),
            "neighbouring rows are at most a quarter turn apart, got 2 rad");
  EXPECT_EQ(
      table(
          {{0, At({0, 0, 0})}, {1e-3, At({0, 0, 0}, {1.5, 0, 0})}, {2, At({0, 0, 0}, {3, 0, 0})}}),
      "rows are too uneven in time to turn between 0.001 s and 2 s: add rows between");
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
