#include "pliant/plants/depth_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/plants/pushing_hand.h"
#include "pliant/systems/recorder.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

const Pose kBehind = LookingAt({1.7, 0, 1.1}, {-0.2, 0, 0.5});

DepthCamera::Options Kinect() {
  DepthCamera::Options o{.model = Lwr()};
  o.view.pose = kBehind;
  return o;
}

/// An arm that is nothing but a ball of 0.1 m about the origin.
RobotModel Ball() {
  return RobotModel::FromUrdfText(R"(<robot name="ball"><link name="base"/><link name="ball">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="turn" type="continuous"><parent link="base"/><child link="ball"/>
    <axis xyz="0 0 1"/></joint></robot>)");
}

/// A wall square to the line of sight at depth z, that fills the picture, and nothing else near.
DepthCamera::Options Wall(double z, int width = 320, int height = 240) {
  DepthCamera::Options o{.model = Ball()};
  o.view = {
      .width = width, .height = height, .focal = 575.8, .pose = LookingAt({5, 0, 0}, {9, 0, 0})};
  o.obstacles = {BoxObstacle{.name = "wall", .center = {5 + z + 0.5, 0, 0}, .size = {1, 20, 20}}};
  return o;
}

DepthImage Taken(const DepthCamera::Options& o) {
  BlockTester<DepthCamera> t(o);
  t.Set(t->position, JointPosition::Zero(o.model.joints()));
  t.Tick();
  return t.Get(t->image);
}

TEST(DepthCamera, SeesABallAtTheDepthOfItsClosedForm) {
  DepthCamera::Options o{.model = Ball(), .noise = DepthNoise::None()};
  o.view.pose = LookingAt({2, 0, 0}, {0, 0, 0});
  const DepthImage image = Taken(o);
  int seen = 0;
  for (int row = 0; row < 480; ++row)
    for (int column = 0; column < 640; ++column) {
      // A line of sight at the angle a to the middle meets the ball at 2 cos a − √(r² − 4 sin² a).
      const Vector3d ray = o.view.Ray(column, row);
      const double cosine = 1 / ray.norm(), sine = 2 * std::sqrt(1 - cosine * cosine);
      if (sine > 0.1) {
        EXPECT_EQ(image.at(column, row), 0);
        continue;
      }
      const double root = std::sqrt(0.01 - sine * sine);
      if (root / 0.1 < std::cos(80.1 * std::numbers::pi / 180)) continue;  // too flat an angle
      if (root / 0.1 < std::cos(79.9 * std::numbers::pi / 180)) continue;
      ++seen;
      EXPECT_NEAR(image.at(column, row), cosine * (2 * cosine - root), 3e-7);  // a float at 2 m
    }
  // A disc of radius f r/√(z² − r²) px, but for the rim beyond 80°.
  const double disc = std::numbers::pi * 575.8 * 575.8 * 0.01 / 3.99;
  EXPECT_NEAR(seen, disc * std::pow(std::sin(80 * std::numbers::pi / 180), 2), 60);
}

TEST(DepthCamera, ReadsNothingOutOfRangeOrAtTooFlatAnAngle) {
  DepthCamera::Options o = Wall(2, 64, 48);
  o.noise = DepthNoise::None();
  EXPECT_THAT(Taken(o).depth, testing::Each(testing::FloatNear(2, 1e-6)));
  o = Wall(4.51, 64, 48);
  o.noise = DepthNoise::None();
  EXPECT_THAT(Taken(o).depth, testing::Each(0));
  o = Wall(0.49, 64, 48);
  o.noise = DepthNoise::None();
  EXPECT_THAT(Taken(o).depth, testing::Each(0));
  // A floor 0.1 m below a camera that looks level: beyond 80°, 0.1 m tan 80° = 0.57 m away.
  o = Wall(2, 64, 480);
  o.noise = DepthNoise::None();
  o.obstacles = {BoxObstacle{.name = "floor", .center = {9, 0, -0.6}, .size = {20, 20, 1}}};
  const DepthImage image = Taken(o);
  for (int row = 0; row < 480; ++row) {
    const Vector3d ray = o.view.Ray(32, row);
    const double angle = std::acos(ray.y() / ray.norm()) * 180 / std::numbers::pi;
    if (ray.y() <= 0 || std::abs(angle - 80) < 0.01) continue;
    const double z = 0.1 / ray.y();
    EXPECT_NEAR(image.at(32, row), angle < 80 && z >= 0.5 ? z : 0, 1e-6) << row;
  }
}

TEST(DepthCamera, HasTheNoiseOfItsModelOnAWall) {
  for (const double z : {0.8, 1.7, 3.0}) {
    DepthCamera::Options o = Wall(z);
    o.noise.step = 0;
    const DepthImage image = Taken(o);
    const Eigen::VectorXd x =
        Eigen::Map<const Eigen::VectorXf>(image.depth.data(), 320 * 240).cast<double>();
    const double sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    EXPECT_LT(std::abs(x.mean() - z) / sigma, MeanBound(x.size()));
    EXPECT_LT(std::abs(Variance(x) / (sigma * sigma) - 1), VarianceBound(x.size()));
    const auto normal = [&](double v) { return 0.5 * std::erfc(-(v - z) / sigma / std::sqrt(2)); };
    EXPECT_LT(DistributionError(x, normal), DistributionBound(x.size()));
  }
}

TEST(DepthCamera, HasMoreNoiseAtFlatAngles) {
  // A wall at 75° to the line of sight in the middle.
  DepthCamera::Options o = Wall(2, 21, 481);
  const double theta = 75 * std::numbers::pi / 180;
  BoxObstacle wall{.name = "wall", .center = {0, 0, 0}, .size = {1, 20, 20}, .rpy = {0, 0, theta}};
  wall.center = Vector3d(7, 0, 0) + 0.5 * Vector3d(std::cos(theta), std::sin(theta), 0);
  o.obstacles = {wall};
  o.noise.step = 0;
  DepthCamera::Options exact = o;
  exact.noise = DepthNoise::None();
  const DepthImage image = Taken(o), without = Taken(exact);
  Eigen::VectorXd x(481);
  for (int row = 0; row < 481; ++row) x(row) = image.at(10, row) - without.at(10, row);
  // Rows up and down turn the line of sight by up to 23°, and the angle to 76.2°: 0.8 mm of σ.
  const double sigma = o.noise.Deviation(2, theta);
  EXPECT_NEAR(sigma, 0.0012 + 0.0019 * 2.56 + 0.0001 / std::sqrt(2) * 25, 1e-9);
  EXPECT_NEAR(std::sqrt(Variance(x)), sigma, 0.0008 + 0.5 * VarianceBound(481) * sigma);
  EXPECT_GT(std::sqrt(Variance(x)), o.noise.Deviation(2) * (1 + VarianceBound(481)));
}

TEST(DepthCamera, HasDepthsInStepsOfTheInverse) {
  for (const double z : {0.8, 1.7, 4.0}) {
    DepthCamera::Options o = Wall(z, 64, 48);
    std::vector<float> depths = Taken(o).depth;
    std::ranges::sort(depths);
    const auto [last, end] = std::ranges::unique(depths);
    depths.erase(last, end);
    ASSERT_GE(depths.size(), 2u);
    for (std::size_t i = 1; i < depths.size(); ++i) {
      const double steps = (1 / depths[i - 1] - 1 / depths[i]) / 0.00285;
      // A float of 1/z: 6e-8 of 1.25 over the step.
      EXPECT_NEAR(steps, std::round(steps), 1e-4);
    }
    const double spacing = 0.00285 * z * z;
    EXPECT_NEAR(depths[depths.size() / 2] - depths[depths.size() / 2 - 1], spacing, 0.1 * spacing);
  }
}

TEST(DepthCamera, DrawsANewNoiseForEachPictureAndSeedAndTheSameAgain) {
  DepthCamera::Options o = Kinect();
  BlockTester<DepthCamera> t(o), again(o);
  o.seed = 2;
  BlockTester<DepthCamera> other(o);
  const JointPosition q{0, 0.7, 0, -1.5, 0, 0.9, 0};
  std::vector<DepthImage> images;
  for (int k = 0; k < 3; ++k) {
    for (auto* tester : {&t, &again, &other}) {
      tester->Set((*tester)->position, q);
      tester->Tick();
    }
    EXPECT_TRUE(t.Get(t->image) == again.Get(again->image));
    EXPECT_FALSE(t.Get(t->image).depth == other.Get(other->image).depth);
    images.push_back(t.Get(t->image));
    EXPECT_NEAR(images.back().time, k / 30.0, 1e-9);
  }
  EXPECT_FALSE(images[0].depth == images[1].depth);
  EXPECT_FALSE(images[1].depth == images[2].depth);
}

TEST(DepthCamera, TakesItsPicturesAtItsRateAndShowsThemUntilTheNext) {
  BlockTester<DepthCamera> t(Kinect());
  t.Set(t->position, JointPosition::Zero(Lwr().joints()));
  t.Tick();
  const DepthImage first = t.Get(t->image);
  t.Set(t->position, JointPosition::Constant(7, 0.3));
  t.AdvanceTo(0.0333);
  EXPECT_TRUE(t.Get(t->image) == first);
  t.AdvanceTo(0.0334);
  EXPECT_FALSE(t.Get(t->image) == first);
}

TEST(DepthCamera, HasAnImageThatIsRestoredWithItsExposure) {
  BlockTester<DepthCamera> t(Kinect());
  const Input<ContactForce>& push = t.Join(t->contacts, {.link = 5, .point = {0.06, 0, 0.1}});
  t.Set(t->position, JointPosition::Constant(7, 0.2));
  t.Tick();
  const Context snapshot = t.simulator().Snapshot();
  const DepthImage before = t.Get(t->image);
  t.Set(push, {.link = 5,
               .point = {0.06, 0, 0.1},
               .force = {-20, 0, 0},
               .moment = Eigen::Vector3d::Zero()});
  t.Set(t->position, JointPosition::Constant(7, 0.4));
  t.Tick();
  EXPECT_FALSE(t.Get(t->image) == before);
  t.simulator().Restore(snapshot);
  EXPECT_TRUE(t.Get(t->image) == before);
}

TEST(DepthCamera, MakesPicturesWithoutHeap) {
  BlockTester<DepthCamera> t(Kinect());
  const Input<ContactForce>& push = t.Join(t->contacts, {});
  t.Set(t->position, JointPosition::Constant(7, 0.2));
  t.Tick();
  t.Get(t->image);
  const long before = Allocations();
  for (int k = 0; k < 5; ++k) {
    t.Set(push, {.link = 5,
                 .point = {0.06, 0, 0.1},
                 .force = {-20, 0, 0},
                 .moment = Eigen::Vector3d::Zero()});
    t.Tick();
    t.Get(t->image);
  }
  EXPECT_EQ(Allocations(), before);
}

TEST(DepthCamera, HoldsTheLaws) {
  BlockTester<DepthCamera> t(Kinect());
  t.Join(t->contacts, {});
  ExpectBlockLaws(std::move(t));
}

/// Pixels that differ, and how much nearer the second picture is there.
struct Difference {
  int pixels = 0;
  double nearer = 0;
};
Difference Between(const DepthImage& a, const DepthImage& b) {
  Difference d;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    if (a.depth[i] == b.depth[i]) continue;
    ++d.pixels;
    if (a.depth[i] > 0) d.nearer = std::max(d.nearer, double{a.depth[i]} - b.depth[i]);
  }
  return d;
}

TEST(DepthCamera, SeesAHandForAForceAndNoneWithout) {
  DepthCamera::Options o = Kinect();
  o.noise = DepthNoise::None();
  BlockTester<DepthCamera> t(o);
  const Input<ContactForce>& push = t.Join(t->contacts, {});
  t.Set(t->position, JointPosition::Zero(o.model.joints()));
  t.Tick();
  const DepthImage none = t.Get(t->image);
  ContactForce force{.link = o.model.link_index("link_5"),
                     .point = {0.0623, 0, 0.0255},
                     .force = {0.001, 0, 0},
                     .moment = Eigen::Vector3d::Zero()};
  t.Set(push, force);  // too small to have a direction
  t.Tick();
  EXPECT_EQ(Between(none, t.Get(t->image)).pixels, 0);
  force.force = {-20, 0, 0};
  for (const int link : {-1, static_cast<int>(o.model.links().size()), 1000}) {
    force.link = link;
    t.Set(push, force);
    t.Tick();
    EXPECT_EQ(Between(none, t.Get(t->image)).pixels, 0) << link;
  }
  force.link = o.model.link_index("link_5");
  t.Set(push, force);
  t.Tick();
  // A forearm that comes towards the camera: a ball of 8 cm and the arm in front of it.
  const Difference seen = Between(none, t.Get(t->image));
  EXPECT_GT(seen.pixels, 400);
  EXPECT_GT(seen.nearer, 0.08);
}

TEST(PushingHand, TouchesWhereTheLineOfForceEntersTheLinkAndStaysOutside) {
  const RobotModel m = Lwr();
  const RobotSurface surface(m);
  RandomStates random(m, 5);
  std::vector<Solid> placed = surface.Solids();
  for (int k = 0; k < 500; ++k) {
    RobotDynamics d(m);
    ComputeDynamics(m, random.q(), JointVelocity::Zero(m.joints()), d);
    surface.Place(d, Pose(), 0, placed);
    const int part = 1 + k % 7;
    const int link = surface.part(part).link;
    const Eigen::VectorXd u = random.Uniform(1);
    const Vector3d inside = placed[static_cast<std::size_t>(part)].center + 0.02 * u.head<3>();
    const Vector3d force = 20 * u.tail<3>();
    const PushingHand hand = HandOf(surface, placed, link, inside, force, 0.04, 0.3);
    const Vector3d arm = hand.touch - inside;
    EXPECT_LT(arm.cross(force.normalized()).norm(), 1e-12);  // the same line
    EXPECT_LT(arm.dot(force), 0);                            // from behind
    EXPECT_NEAR(surface.NearestOnLink(link, placed, hand.touch).distance, 0, 1e-12);
    EXPECT_NEAR(surface.NearestOnLink(link, placed, hand.center).distance, 0.04, 1e-12);
    for (double s = 0; s <= 1; s += 0.05) {
      const Vector3d on = hand.center + s * (hand.elbow - hand.center);
      EXPECT_GE(surface.NearestOnLink(link, placed, on).distance, 0.04 - 1e-12);
    }
  }
}

TEST(DepthCamera, RefusesWhatItCannotSee) {
  const auto refused = [](auto&& change) {
    DepthCamera::Options o = Kinect();
    change(o);
    return ErrorOf([&] { BlockTester<DepthCamera> t(o); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused([](auto& o) { o.view.focal = 0; }), HasSubstr("view.focal must be > 0"));
  EXPECT_THAT(refused([](auto& o) { o.view.width = 0; }),
              HasSubstr("view.width must be from 1 to 4096"));
  EXPECT_THAT(refused([](auto& o) { o.view.width = -1; }),
              HasSubstr("view.width must be from 1 to 4096 px, got -1"));
  EXPECT_THAT(refused([](auto& o) { o.noise.growth = -1; }),
              HasSubstr("noise.growth must be >= 0"));
  EXPECT_THAT(refused([](auto& o) { o.farthest = 0.4; }),
              HasSubstr("farthest must be > nearest = 0.5 m, got 0.4"));
  EXPECT_THAT(refused([](auto& o) { o.forearm_radius = 0.05; }),
              HasSubstr("forearm_radius must be at most hand_radius = 0.04 m"));
  EXPECT_THAT(
      refused([](auto& o) {
        o.obstacles = {HullObstacle{
            .name = "rock", .points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .radius = 0.1}};
      }),
      HasSubstr("rock: a depth camera sees hulls with sharp edges"));
  EXPECT_THAT(refused([](auto& o) {
                o.model = RobotModel::FromUrdfText(R"(<robot name="ghost"><link name="base"/>
                  <link name="arm"><inertial><mass value="1"/>
                  <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
                  <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>
                  <axis xyz="0 0 1"/></joint></robot>)");
              }),
              HasSubstr("the robot 'ghost' has no collision shapes"));
}

TEST(DepthCamera, HasAnImageThatALogRefuses) {
  DiagramBuilder b;
  auto& camera = b.Add<DepthCamera>("camera", Kinect());
  auto& q = b.Add<Constant<JointPosition>>(
      "q", {.space = Lwr().joints(), .value = JointPosition::Zero(Lwr().joints())});
  struct Nowhere final : RecordSink {
    int Open(std::vector<RecordedValue>) override { return 0; }
    std::span<double> Begin(int, std::int64_t) noexcept override { return {}; }
    void Commit() noexcept override {}
  };
  auto& recorder = b.Add<Recorder>("log", {.period = 1ms, .sink = std::make_shared<Nowhere>()});
  b.Connect(q.y, camera.position);
  b.Connect(camera.image, recorder.in);
  EXPECT_THAT(
      ErrorOf([&] { b.Build(); }),
      testing::HasSubstr("cannot log camera.image : depth image, which is not made of numbers"));
}

}  // namespace
}  // namespace pliant
