// What keeping shapes apart costs: rows of a controller's tick, and single distances.

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/controllers/collision_damper.h"
#include "pliant/systems/block_tester.h"

namespace pliant {
namespace {

RobotModel Gen3() { return RobotModel::FromUrdf(PLIANT_SOURCE_DIR "/models/gen3/gen3_7dof.urdf"); }

/// A Gen3 with `pairs` obstacles, each against the forearm's capsule, which four joints move:
/// `near` of them 10 cm away, the others 2 m.
CollisionDamper::Options Pairs(int pairs, int near, bool boxes) {
  CollisionDamper::Options o{.model = Gen3()};
  std::vector<std::string> all, others;
  for (const Link& link : o.model.links()) {
    all.push_back(link.name);
    if (link.name != "forearm_link") others.push_back(link.name);
  }
  o.pairs.ignore = {{all, all}};
  for (int i = 0; i < pairs; ++i) {
    const double angle = 0.7 * i, away = i < near ? 0.2 : 2;
    const Eigen::Vector3d center{0.25 + away * std::cos(angle), away * std::sin(angle), 0.55};
    const std::string name = "obstacle_" + std::to_string(i);
    if (boxes)
      o.obstacles.push_back(
          BoxObstacle{.name = name, .center = center, .size = {0.1, 0.1, 0.3}, .except = others});
    else
      o.obstacles.push_back(CapsuleObstacle{.name = name,
                                            .a = center - Eigen::Vector3d(0, 0.02 * i, 0.1),
                                            .b = center + Eigen::Vector3d(0, 0.02 * i, 0.1),
                                            .radius = 0.04,
                                            .except = others});
  }
  return o;
}

/// Dynamics are ready; time is that of the rows alone, and of the simulator that asks for them.
void Tick(benchmark::State& state, const CollisionDamper::Options& o) {
  BlockTester<CollisionDamper> t(o);
  RobotDynamics d(o.model);
  JointPosition q{0, 0.2618, 3.14, -2.2689, 0.1, 0.9599, 1.57};
  ComputeDynamics(o.model, q, JointVelocity(0.1 * PerJoint::Ones(7)), d);
  t.Set(t->dynamics, d);
  int rows = 0;
  for (auto _ : state) {
    t.Set(t->dynamics, d);
    const AccelerationRows& out = t.Get(t->rows);
    benchmark::DoNotOptimize(out.lower.data());
    benchmark::ClobberMemory();
    rows = static_cast<int>((out.lower.array() > -1e300).count());
  }
  state.counters["rows"] = rows;
}

void BM_CollisionRows(benchmark::State& state) {
  Tick(state, Pairs(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), false));
}
BENCHMARK(BM_CollisionRows)
    ->ArgNames({"pairs", "near"})
    ->Args({0, 0})
    ->Args({5, 5})
    ->Args({10, 5})
    ->Args({10, 10})
    ->Args({30, 5})
    ->Args({60, 5});

void BM_CollisionRowsOfBoxes(benchmark::State& state) {
  Tick(state, Pairs(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), true));
}
BENCHMARK(BM_CollisionRowsOfBoxes)->ArgNames({"pairs", "near"})->Args({5, 5})->Args({30, 5});

/// One distance, softened, of shapes 5 cm apart; the second turns.
void Distance(benchmark::State& state, const CollisionShape& a, const CollisionShape& b, double z) {
  Eigen::Matrix3d R_a = Eigen::Matrix3d::Identity(), R_b = R_a;
  double angle = 0.1;
  for (auto _ : state) {
    angle += 0.01;
    R_b = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    benchmark::DoNotOptimize(
        Closest({a, R_a, {0, 0, 0}}, {b, R_b, Eigen::Vector3d(0.01, 0.02, z)}, 5e-4));
  }
}
void BM_DistanceOfCapsules(benchmark::State& state) {
  const CollisionShape a = CollisionShape::Capsule({-0.1, 0, 0}, {0.1, 0, 0}, 0.05);
  Distance(state, a, a, 0.2);
}
BENCHMARK(BM_DistanceOfCapsules);
void BM_DistanceOfCapsuleAndBox(benchmark::State& state) {
  Distance(state, CollisionShape::Capsule({-0.1, 0, 0}, {0.1, 0, 0}, 0.05),
           CollisionShape::Box(Pose(), {0.2, 0.2, 0.2}), 0.25);
}
BENCHMARK(BM_DistanceOfCapsuleAndBox);
void BM_DistanceOfBoxes(benchmark::State& state) {
  const CollisionShape a = CollisionShape::Box(Pose(), {0.2, 0.2, 0.2});
  Distance(state, a, a, 0.4);
}
BENCHMARK(BM_DistanceOfBoxes);
void BM_DistanceOfOverlappingBoxes(benchmark::State& state) {
  const CollisionShape a = CollisionShape::Box(Pose(), {0.2, 0.2, 0.2});
  Distance(state, a, a, 0.1);
}
BENCHMARK(BM_DistanceOfOverlappingBoxes);

}  // namespace
}  // namespace pliant
