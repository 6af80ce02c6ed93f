#include "pliant/controllers/workspace_planes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

WorkspacePlanes::Options Box(const RobotModel& m) {
  return {.model = m,
          .frame = "tool_frame",
          .point = {0.01, -0.02, 0.05},
          .planes = {{{0, 0, 2}, {0, 0, 0.1}}, {{-1, 1, 0}, {0.8, 0, 0}}},
          .safety_distance = 0.02};
}

TEST(WorkspacePlanes, MeasuresTheDistanceOfThePointAlongUnitNormals) {
  const RobotModel m = Gen3();
  RandomStates random(m, 51);
  BlockTester<WorkspacePlanes> t(Box(m));
  for (int k = 0; k < 200; ++k) {
    const RobotDynamics d = At(m, random.q(), random.v());
    t.Set(t->dynamics, d);
    const Eigen::Vector3d p =
        PointDynamics(m, d, m.link_index("tool_frame"), {0.01, -0.02, 0.05}).pose.position;
    EXPECT_NEAR(t.Get(t->distance)(0), p.z() - 0.1, 1e-14);
    EXPECT_NEAR(t.Get(t->distance)(1), (0.8 - p.x() + p.y()) / std::sqrt(2), 1e-14);
  }
}

TEST(WorkspacePlanes, AsksForTheAccelerationOfTheDistanceThatTheDamperDoes) {
  const RobotModel m = Gen3();
  RandomStates random(m, 52);
  BlockTester<WorkspacePlanes> t(Box(m));
  const double h = 1e-4;
  for (int k = 0; k < 200; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    // e along q(t) = q + v t + ½ a t²: its rates by central differences.
    const auto distance = [&](double s) {
      t.Set(t->dynamics, At(m, q + s * v + 0.5 * s * s * a, v + s * a));
      return TaskVector(t.Get(t->distance));
    };
    const TaskVector before = distance(-h), after = distance(h), e = distance(0);
    const TaskVector rate = (after - before) / (2 * h);
    const TaskVector acceleration = (after - 2 * e + before) / (h * h);
    const AccelerationRows& rows = t.Get(t->rows);
    for (int i = 0; i < 2; ++i) {
      const double least = -100 * rate(i) - 100 * 100 / 16.0 * (e(i) - 0.02);
      // h² e'''' /12 with rates of some (10 rad/s)⁴ · 1 m, and round-off of 1e-16/h²
      EXPECT_NEAR(rows.A.row(i).dot(a) - rows.lower(i), acceleration(i) - least, 2e-4);
      EXPECT_EQ(rows.upper(i), HUGE_VAL);
    }
  }
}

TEST(WorkspacePlanes, RefusesPlanesThatAreNone) {
  const RobotModel m = Gen3();
  const auto error = [&](WorkspacePlanes::Options o) {
    return ErrorOf([&] { WorkspacePlanes planes(o); });
  };
  WorkspacePlanes::Options o = Box(m);
  o.planes.clear();
  EXPECT_EQ(error(o), "a frame has from 1 to 6 planes, got 0");
  o = Box(m);
  o.planes.assign(7, o.planes.front());
  EXPECT_EQ(error(o), "a frame has from 1 to 6 planes, got 7");
  o.planes.assign(100, o.planes.front());
  EXPECT_EQ(error(o), "a frame has from 1 to 6 planes, got 100");
  o = Box(m);
  o.planes[1].normal.setZero();
  EXPECT_EQ(error(o), "plane 1: the length of normal must be > 0, got 0");
  o = Box(m);
  o.planes[0].point(1) = HUGE_VAL;
  EXPECT_EQ(error(o), "plane 0: point[y] must be finite m, got inf");
  o = Box(m);
  o.safety_distance = -1;
  EXPECT_EQ(error(o), "safety_distance must be >= 0 m, got -1");
  o = Box(m);
  o.damper.rate = 0;
  EXPECT_EQ(error(o), "damper.rate must be > 0 1/s, got 0");
  o = Box(m);
  o.frame = "tool";
  EXPECT_NE(error(o).find("tool_frame"), std::string::npos) << error(o);
}

}  // namespace
}  // namespace pliant
