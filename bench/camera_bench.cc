// What seeing contacts costs: a picture of a depth camera, and the localisation in it.

#include <benchmark/benchmark.h>

#include <optional>

#include "pliant/estimators/contact_localization.h"
#include "pliant/plants/depth_camera.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/block_tester.h"

namespace pliant {
namespace {

/// A KUKA LWR IV+ as the experiments start it, pushed on a link; with a wall, every pixel reads.
struct Scene {
  explicit Scene(bool wall) {
    DepthCamera::Options c{.model = model};
    c.view.pose = LookingAt({1.7, 0, 1.1}, {-0.2, 0, 0.5});
    if (wall)
      c.obstacles = {BoxObstacle{.name = "wall", .center = {-2.5, 0, 0}, .size = {0.2, 20, 20}}};
    camera.emplace(c);
    ContactLocalization::Options o{.model = model, .obstacles = c.obstacles};
    o.view = c.view;
    localization.emplace(o);
    const ContactForce push{.link = model.link_index("link_5"),
                            .point = {0.0623, 0, 0.1},
                            .force = {0, -20, 0},
                            .moment = Eigen::Vector3d::Zero()};
    camera->Join((*camera)->contacts, push);
    const JointPosition q{0, 0.698, 0, -1.571, 0, 0.873, 0};
    camera->Set((*camera)->position, q);
    ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), dynamics);
    localization->Set((*localization)->dynamics, dynamics);
  }

  const DepthImage& Picture() {
    camera->Tick();
    return camera->Get((*camera)->image);
  }
  const Contacts& Find(const DepthImage& image) {
    localization->Set((*localization)->image, image);
    localization->Tick();
    return localization->Get((*localization)->contacts);
  }

  RobotModel model = RobotModel::FromUrdf(ModelFile("lwr/lwr4p.urdf"));
  RobotDynamics dynamics{model};
  std::optional<BlockTester<DepthCamera>> camera;
  std::optional<BlockTester<ContactLocalization>> localization;
};

void Picture(benchmark::State& state, bool wall) {
  Scene scene(wall);
  for (auto _ : state) benchmark::DoNotOptimize(scene.Picture().depth.data());
}
BENCHMARK_CAPTURE(Picture, Arm, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Picture, ArmAndWall, true)->Unit(benchmark::kMillisecond);

void Localization(benchmark::State& state, bool wall) {
  Scene scene(wall);
  int found = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const DepthImage& image = scene.Picture();
    state.ResumeTiming();
    found += scene.Find(image).count();
  }
  state.counters["found"] = benchmark::Counter(found, benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(Localization, Arm, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Localization, ArmAndWall, true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pliant
