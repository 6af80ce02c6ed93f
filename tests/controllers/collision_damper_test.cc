#include "pliant/controllers/collision_damper.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/plants/parameter_file.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kEveryRow = 1e9;  // a closing acceleration that leaves no pair without a row

/// A table, a ball, a pole and a ramp within the arm's reach.
std::vector<Obstacle> Room() {
  return {BoxObstacle{.name = "table", .center = {0.5, 0, -0.05}, .size = {0.6, 1.2, 0.1}},
          SphereObstacle{.name = "ball", .center = {-0.3, 0.4, 0.7}, .radius = 0.1},
          CapsuleObstacle{.name = "pole", .a = {0.5, 0.5, 0}, .b = {0.5, 0.5, 1}, .radius = 0.03},
          HullObstacle{.name = "ramp",
                       .points = {{-0.9, -0.4, 0},
                                  {-0.4, -0.4, 0},
                                  {-0.9, 0.2, 0},
                                  {-0.4, 0.2, 0},
                                  {-0.9, -0.4, 0.4},
                                  {-0.9, 0.2, 0.4}}}};
}

CollisionDamper::Options Gen3InARoom() {
  return {.model = Gen3(),
          .pairs = CollisionPairs::Read(ModelFile("gen3/collisions.yaml"), Gen3()),
          .obstacles = Room()};
}

RobotDynamics At(const RobotModel& m, const JointPosition& q, const JointVelocity& v) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, v, d);
  return d;
}

/// What a pair does by the formulas, from the dynamics of its points.
struct Expected {
  Expected(const CollisionGeometry& geometry, int pair, const RobotModel& m, const RobotDynamics& d,
           double softening) {
    CollisionGeometry::Placement placement;
    geometry.Place(d, placement);
    const auto [a, b] = geometry.pairs()[static_cast<std::size_t>(pair)];
    p = Closest(placement[static_cast<std::size_t>(a)], placement[static_cast<std::size_t>(b)],
                softening);
    row.setZero(m.size());
    for (const auto& [part, x, sign] : {std::tuple{a, p.a, 1.0}, std::tuple{b, p.b, -1.0}}) {
      const int link = geometry.part(part).link;
      if (link < 0) continue;
      const Pose X = LinkPose(m, d, link);
      const FrameDynamics f = PointDynamics(m, d, link, X.rotation.transpose() * (x - X.position));
      row += sign * f.J.bottomRows<3>().transpose() * p.normal;
      beta += sign * p.normal.dot(f.Jdot_v.tail<3>());
      w += sign * f.twist.tail<3>();
      (sign > 0 ? omega_a : omega_b) = f.twist.head<3>();
    }
    edot = row.dot(d.v);
    const double R_a = geometry.part(a).shape.extent, R_b = geometry.part(b).shape.extent;
    const double z = p.normal.dot(p.a - p.b);
    const Vector3d c = (R_a > R_b ? omega_a : omega_b).cross(p.normal);
    beta += 2 * w.dot(c) - z * c.squaredNorm();
    const double R = std::min(R_a, R_b);
    least_kappa = -(omega_a - omega_b).squaredNorm() * R * R / softening;
    most_kappa = (w - p.normal * edot - z * c).squaredNorm() / z;
    points = R_a == 0 && R_b == 0;
  }

  Proximity p;
  Eigen::VectorXd row;
  double beta = 0, edot, least_kappa, most_kappa;
  Vector3d w = Vector3d::Zero(), omega_a = Vector3d::Zero(), omega_b = Vector3d::Zero();
  bool points;
};

TEST(CollisionDamper, BoundsAccelerationAsTheFormulasSay) {
  CollisionDamper::Options o = Gen3InARoom();
  o.closing_acceleration = kEveryRow;
  o.damper = {.rate = 70, .damping_ratio = 3};
  o.priority = 5;
  BlockTester<CollisionDamper> t(o);
  RandomStates random(o.model, 41);
  for (int k = 0; k < 300; ++k) {
    const RobotDynamics d = At(o.model, random.q(), random.v());
    t.Set(t->dynamics, d);
    const AccelerationRows& rows = t.Get(t->rows);
    EXPECT_EQ(rows.priority, 5);
    ASSERT_EQ(rows.A.rows(), t->geometry().size());
    for (int i = 0; i < rows.A.rows(); ++i) {
      const Expected pair(t->geometry(), i, o.model, d, o.softening);
      EXPECT_LT((rows.A.row(i).transpose() - pair.row).norm(), 1e-12) << t->geometry().names()[i];
      const double least = -70 * pair.edot - 70 * 70 / 36.0 * (pair.p.distance - 0.015);  // EC (24)
      if (pair.row.norm() < 1e-9) {
        EXPECT_EQ(rows.lower(i), -HUGE_VAL) << "no joint changes it";
      } else {
        EXPECT_NEAR(rows.lower(i), least - pair.beta, 1e-10);  // of numbers up to 100
      }
      EXPECT_EQ(rows.upper(i), HUGE_VAL);
      EXPECT_EQ(t.Get(t->distance)(i), pair.p.distance);
    }
  }
}

TEST(CollisionDamper, LeavesOutOnlyWhatTheDistanceBendsBy) {
  // e along q + v t + a t²/2, by differences; κ is what rows leave out of ë.
  CollisionDamper::Options o = Gen3InARoom();
  const CollisionGeometry geometry(o.model, o.pairs, o.obstacles);
  RandomStates random(o.model, 43);
  const double h = 1e-4;
  int of_points = 0;
  for (int k = 0; k < 300; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointAcceleration a = random.a();
    const auto e = [&](double t) {
      const JointPosition at = q + t * v + 0.5 * t * t * a;
      return geometry.Distances(At(o.model, at, v), o.softening);
    };
    const RobotDynamics d = At(o.model, q, v);
    const PairDistances before = e(-h), now = e(0), after = e(h);
    for (int i = 0; i < geometry.size(); ++i) {
      const Expected pair(geometry, i, o.model, d, o.softening);
      if (pair.p.normal.dot(pair.p.a - pair.p.b) < 0.03) continue;
      // κ jumps where a point comes to an end of its core: then differences are those of a part.
      const double bent = pair.most_kappa - pair.least_kappa + a.norm() + v.squaredNorm();
      EXPECT_NEAR((after(i) - before(i)) / (2 * h), pair.edot, h * bent) << geometry.names()[i];
      const double kappa =
          (after(i) - 2 * now(i) + before(i)) / (h * h) - pair.beta - pair.row.dot(a);
      // Rates change by some v/z < 100 1/s: over h, by 1 %.
      const double tolerance = 1e-2 * bent;
      EXPECT_GE(kappa, pair.least_kappa - tolerance) << geometry.names()[i];
      EXPECT_LE(kappa, pair.most_kappa + tolerance) << geometry.names()[i];
      if (!pair.points) continue;
      ++of_points;
      EXPECT_NEAR(kappa, pair.most_kappa, tolerance) << "between points it is all of it";
    }
  }
  EXPECT_GT(of_points, 200);
}

TEST(CollisionDamper, LeavesOutNoRowThatBindsBelowTheClosingAcceleration) {
  CollisionDamper::Options o = Gen3InARoom();
  for (const double A : {5.0, 100.0}) {
    o.closing_acceleration = A;
    BlockTester<CollisionDamper> t(o);
    RandomStates random(o.model, 47);
    int rows_there = 0, rows_left_out = 0;
    for (int k = 0; k < 500; ++k) {
      const RobotDynamics d = At(o.model, random.q(), random.v());
      t.Set(t->dynamics, d);
      const AccelerationRows& rows = t.Get(t->rows);
      for (int i = 0; i < rows.A.rows(); ++i) {
        const Expected pair(t->geometry(), i, o.model, d, o.softening);
        if (pair.row.norm() < 1e-9) continue;
        const bool is_there = std::isfinite(rows.lower(i));
        EXPECT_EQ(is_there, o.damper.Least(pair.p.distance - o.safety_distance, pair.edot) > -A);
        EXPECT_EQ(is_there, !rows.A.row(i).isZero());
        ++(is_there ? rows_there : rows_left_out);
      }
    }
    EXPECT_GT(rows_there, 100);
    EXPECT_GT(rows_left_out, 100);
  }
}

TEST(CollisionDamper, HasNoRowForWhatNoJointChanges) {
  // A ball on the axis of joint 7, on which the bracelet's sphere turns; all else is excepted.
  CollisionDamper::Options o{.model = Gen3()};
  o.pairs.ignore = {
      {{"base_link", "shoulder_link", "half_arm_1_link", "half_arm_2_link", "forearm_link",
        "spherical_wrist_1_link", "spherical_wrist_2_link", "bracelet_link"},
       {"base_link", "shoulder_link", "half_arm_1_link", "half_arm_2_link", "forearm_link",
        "spherical_wrist_1_link", "spherical_wrist_2_link", "bracelet_link"}}};
  o.obstacles = {SphereObstacle{
      .name = "hat",
      .center = {0, 0, 1},
      .radius = 0.1,
      .except = {"half_arm_1_link", "half_arm_2_link", "forearm_link", "spherical_wrist_1_link",
                 "spherical_wrist_2_link", "bracelet_link"}}};
  o.closing_acceleration = kEveryRow;
  BlockTester<CollisionDamper> t(o);
  t.Set(t->dynamics,
        At(o.model, JointPosition::Zero(o.model.joints()), JointVelocity::Zero(o.model.joints())));
  // The shoulder turns about the vertical, and its upper end lies on it.
  EXPECT_EQ(t.Get(t->rows).lower.size(), 1);
  EXPECT_EQ(t.Get(t->rows).lower(0), -HUGE_VAL);
  EXPECT_GT(t.Get(t->distance)(0), 0);
}

/// The largest changes of row and bound of one pair in a step, while joint 4 turns the forearm
/// through the pose in which it is parallel to a capsule beside it.
struct Sweep {
  Sweep(double step, double softening) {
    const RobotModel m = Gen3();
    JointPosition q{0.2, 0.5, 0.3, -1.5, 0.4, 0.7, 0.1};
    JointVelocity v = 0.3 * PerJoint::Ones(7);
    // The capsule lies along the forearm's axis, 15 cm beside it.
    const RobotDynamics d = At(m, q, v);
    const Pose X = LinkPose(m, d, m.link_index("forearm_link"));
    const Shape& forearm = m.link(m.link_index("forearm_link")).collisions[0];
    const Pose X_C = X * forearm.pose;
    const Vector3d z = d.body[3].rotation.col(2);  // of joint 4; normal to the forearm
    const Vector3d side = z.cross(X_C.rotation.col(2)).normalized();
    const Vector3d center = X_C.position + 0.15 * side, half = 0.2 * X_C.rotation.col(2);
    CollisionDamper::Options o{.model = m};
    o.pairs.watch = {{{"base_link"}, {"spherical_wrist_1_link"}}};
    o.obstacles = {CapsuleObstacle{
        .name = "bar",
        .a = center - half,
        .b = center + half,
        .radius = 0.02,
        .except = {"shoulder_link", "half_arm_1_link", "half_arm_2_link", "spherical_wrist_1_link",
                   "spherical_wrist_2_link", "bracelet_link"}}};
    o.softening = softening;
    o.closing_acceleration = kEveryRow;
    BlockTester<CollisionDamper> t(o);
    const int pair = t->geometry().size() - 1;
    const double middle = q(3);
    PerJoint row_before;
    double lower_before = 0;
    const int steps = static_cast<int>(std::round(0.05 / step));
    for (int i = -steps; i <= steps; ++i) {
      q(3) = middle + i * step;
      t.Set(t->dynamics, At(m, q, v));
      const AccelerationRows& rows = t.Get(t->rows);
      const PerJoint now = rows.A.row(pair).transpose();
      if (i > -steps) {
        row = std::max(row, (now - row_before).norm());
        lower = std::max(lower, std::abs(rows.lower(pair) - lower_before));
      }
      row_before = now;
      lower_before = rows.lower(pair);
    }
  }
  double row = 0, lower = 0;
};

TEST(CollisionDamper, HasRowsAndBoundsThatDoNotJumpWhereLinksBecomeParallel) {
  const double step = 1e-4, delta = 5e-4;
  const Sweep coarse(step, delta), fine(step / 10, delta);
  // With δ = 0 the closest points jump from end to end, and so do rows.
  const Sweep sharp(step, 1e-12);
  EXPECT_GT(sharp.row, 0.03);
  EXPECT_LT(coarse.row, sharp.row / 10);
  // Lipschitz: a tenth of the step, a tenth of the change.
  EXPECT_NEAR(fine.row, coarse.row / 10, 0.01 * coarse.row);
  EXPECT_NEAR(fine.lower, coarse.lower / 10, 0.01 * coarse.lower);
  // With L = 0.8 m to the furthest axis, R = 0.097 m and z ≥ 0.14 m, for a turn of θ = 1e-4:
  // w ≤ 0.3 θ (from joint 4), s = R²/δ (θ + w/z), and a column changes by ‖Δx‖ + L ‖Δn‖.
  const double w = 0.3 * step, s = 0.097 * 0.097 / delta * (step + w / 0.14);
  const double column = (w + s) + 0.8 * ((w + s) / 0.14 + step);
  EXPECT_LT(coarse.row, std::sqrt(4) * column) << "four joints move the forearm";
  // λ Δė + λ²/(4M²) Δe + the change of nᵀ J̇ q̇, which is to J̇ q̇ as the row is to J q̇.
  EXPECT_LT(coarse.lower, (100 + 2) * std::sqrt(4) * column * 0.3 * std::sqrt(4) + 625 * w);
}

/// A Gen3 whose acceleration is what drives it to a posture, changed as little as its rows ask for;
/// held at 1 kHz.
struct Driven {
  Driven(const CollisionDamper::Options& o, JointPosition q, const JointPosition& goal,
         double seconds) {
    BlockTester<CollisionDamper> t(o);
    const double h = 1e-3;
    JointVelocity v = JointVelocity::Zero(o.model.joints());
    for (int k = 0; k < seconds / h; ++k) {
      const RobotDynamics d = At(o.model, q, v);
      t.Set(t->dynamics, d);
      const AccelerationRows& rows = t.Get(t->rows);
      Eigen::VectorXd a = 100 * (goal - q) - 20 * v;
      // Kaczmarz's projections, until all rows hold.
      bool all_hold = false;
      for (int round = 0; round < 500 && !all_hold; ++round) {
        all_hold = true;
        for (int i = 0; i < rows.A.rows(); ++i)
          if (const double lack = rows.lower(i) - rows.A.row(i).dot(a); lack > 1e-9) {
            a += lack / rows.A.row(i).squaredNorm() * rows.A.row(i).transpose();
            all_hold = false;
          }
      }
      q += h * v + 0.5 * h * h * a;
      v += h * a;
      const PairDistances e = t->geometry().Distances(At(o.model, q, v));
      Eigen::Index pair;
      if (const double now = e.minCoeff(&pair); now < least) {
        least = now;
        closest = t->geometry().names()[static_cast<int>(pair)];
      }
      end = e.minCoeff();
      fastest = std::max(fastest, v.norm());
    }
    without = t->geometry().Distances(At(o.model, goal, v)).minCoeff();
  }
  double least = 1, end = 1, without, fastest = 0;
  std::string closest;
};

TEST(CollisionDamper, KeepsTheArmOffItself) {
  CollisionDamper::Options o = Gen3InARoom();
  o.obstacles = {};
  // The hand into the shoulder, from retract; the wrist into the upper arm.
  const JointPosition retract{0, -0.349, kPi, -2.548, 0, -0.873, kPi / 2};
  for (const JointPosition& goal : {JointPosition{0, -0.6, kPi, -2.56, 0, -1.3, kPi / 2},
                                    JointPosition{0, -0.349, kPi, -2.56, 0.5, -2.0, kPi / 2}}) {
    const Driven run(o, retract, goal, 2);
    EXPECT_LT(run.without, 0) << "the goal lies in a collision";
    // What κ takes is none where a sphere goes along a capsule; sampling adds 1/2 ë h² at most.
    EXPECT_GE(run.least, 0.015 - 1e-4) << run.closest;
    EXPECT_LT(run.end, 0.015 + 2 * o.softening) << "it comes up to d_s";
  }
}

TEST(CollisionDamper, KeepsTheArmOutOfObstacles) {
  CollisionDamper::Options o = Gen3InARoom();
  const JointPosition home{0, 0.2618, kPi, -2.2689, 0, 0.9599, kPi / 2};
  for (const JointPosition& goal :
       {JointPosition{0, 1.4, kPi, -1.6, 0, 0.9599, kPi / 2},       // into the table
        JointPosition{2.2, 0.2618, kPi, -2.0, 0, 0.5, kPi / 2},     // past the ball
        JointPosition{0.9, 0.9, kPi, -1.2, 0, 0.4, kPi / 2},        // through the pole
        JointPosition{3.0, 1.3, kPi, -1.2, 0, 0.9599, kPi / 2}}) {  // into the ramp
    const Driven run(o, home, goal, 2);
    EXPECT_GE(run.least, 0.015 - 1e-3) << run.closest << ", what κ takes, 2 ω R/λ, is above 1 mm";
  }
}

TEST(CollisionDamper, PushesOutWhatHasPenetrated) {
  CollisionDamper::Options o = Gen3InARoom();
  BlockTester<CollisionDamper> t(o);
  RandomStates random(o.model, 51);
  int inside = 0;
  for (int k = 0; k < 2000; ++k) {
    t.Set(t->dynamics, At(o.model, random.q(), JointVelocity::Zero(o.model.joints())));
    const PairDistances& e = t.Get(t->distance);
    const AccelerationRows& rows = t.Get(t->rows);
    for (int i = 0; i < e.size(); ++i) {
      if (e(i) > 0) continue;
      ++inside;
      // At rest ë ≥ λ²/(4M²) (d_s − e), also where cores overlap, but for rows without effect.
      if (std::isfinite(rows.lower(i))) {
        EXPECT_NEAR(rows.lower(i), 625 * (0.015 - e(i)), 1e-9);
      }
    }
  }
  EXPECT_GT(inside, 200);
}

TEST(CollisionDamper, TakesNothingFromTheHeap) {
  const CollisionDamper::Options o = Gen3InARoom();
  BlockTester<CollisionDamper> t(o);
  RandomStates random(o.model, 53);
  for (int k = 0; k < 300; ++k) {
    const RobotDynamics d = At(o.model, random.q(), random.v());
    t.Set(t->dynamics, d);
    t.simulator();
    const long before = Allocations();
    t.Get(t->rows);
    t.Get(t->distance);
    if (k > 0) {
      EXPECT_EQ(Allocations(), before);
    }
  }
}

TEST(CollisionDamper, NamesThePairsOfItsDistances) {
  BlockTester<CollisionDamper> t(Gen3InARoom());
  t.Set(t->dynamics,
        At(Gen3(), JointPosition::Zero(Gen3().joints()), JointVelocity::Zero(Gen3().joints())));
  EXPECT_EQ(t.Get(t->distance).size(), 12 + 4 * 7);
  EXPECT_THAT(t->distance.describe(), testing::HasSubstr("distances [m] (base_link-"));
}

TEST(CollisionDamper, IsFedByAScenarioFile) {
  CollisionDamper::Options o{.model = Gen3()};
  ParameterFile::ReadText(R"(
pairs: {watch: [{links: [base_link], against: [bracelet_link]}]}
obstacles: [!Sphere {name: head, center: [0, 1, 0.5], radius: 12 cm}]
damper: {rate: 50}
safety_distance: 20 mm
)",
                          "scene.yaml")
      .Fill(o);
  BlockTester<CollisionDamper> t(o);
  EXPECT_EQ(t->geometry().size(), 1 + 7);
  EXPECT_EQ(o.damper.rate, 50);
  EXPECT_EQ(o.safety_distance, 0.02);
}

TEST(CollisionDamper, RefusesOptionsThatKeepNothingApart) {
  const auto error = [](const auto& change) {
    CollisionDamper::Options o{.model = Gen3()};
    change(o);
    return ErrorOf([&] { CollisionDamper damper(o); });
  };
  using Options = CollisionDamper::Options;
  EXPECT_EQ(error([](Options& o) { o.safety_distance = -1; }),
            "safety_distance must be >= 0 m, got -1");
  EXPECT_EQ(error([](Options& o) { o.softening = 0; }), "softening must be > 0 m, got 0");
  EXPECT_EQ(error([](Options& o) { o.closing_acceleration = 0; }),
            "closing_acceleration must be > 0 m/s², got 0");
  EXPECT_EQ(error([](Options& o) { o.priority = 0; }), "priority must be >= 1, got 0");
  EXPECT_EQ(error([](Options& o) { o.damper.rate = 0; }), "damper.rate must be > 0 1/s, got 0");
  EXPECT_EQ(error([](Options& o) { o.damper.damping_ratio = 0.5; }),
            "damper.damping_ratio must be >= 1, got 0.5");
}

}  // namespace
}  // namespace pliant
