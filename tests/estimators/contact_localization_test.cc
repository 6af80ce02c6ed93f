#include "pliant/estimators/contact_localization.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "pliant/plants/depth_camera.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/pushing_hand.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

const JointPosition kStart{0, 0.698, 0, -1.571, 0, 0.873, 0};

/// A camera, the localisation that looks at its pictures, and the arm between them.
struct Rig {
  explicit Rig(const Pose& camera_pose = LookingAt({1.7, 0, 1.1}, {-0.2, 0, 0.5}),
               const DepthNoise& noise = {}, ContactLocalization::Options o = {.model = Lwr()},
               std::vector<Obstacle> obstacles = {})
      : model{o.model} {
    DepthCamera::Options c{.model = model, .noise = noise};
    c.view.pose = camera_pose;
    c.obstacles = obstacles;
    o.view = c.view;
    o.noise = noise;
    camera = &b.Add<DepthCamera>("camera", c);
    localization = &b.Add<ContactLocalization>("localization", o);
    q = &b.Add<Constant<JointPosition>>("q", {.space = model.joints(), .value = kStart});
    measured =
        &b.Add<Constant<JointPosition>>("measured", {.space = model.joints(), .value = kStart});
    still = &b.Add<Constant<JointVelocity>>(
        "still", {.space = model.joints(), .value = JointVelocity::Zero(model.joints())});
    auto& dynamics = b.Add<ModelDynamics>("dynamics", {.model = model});
    touched = &b.Add<Constant<bool>>("touched", {.value = true});
    isolated = &b.Add<Constant<int>>("isolated", {.value = -1});
    for (std::size_t i = 0; i < push.size(); ++i) {
      push[i] = &b.Add<Constant<ContactForce>>("push_" + std::to_string(i), {});
      b.Connect(push[i]->y, camera->contacts);
    }
    b.Connect(q->y, camera->position);
    b.Connect(measured->y, dynamics.position);
    b.Connect(still->y, dynamics.velocity);
    b.Connect(camera->image, localization->image);
    b.Connect(dynamics.dynamics, localization->dynamics);
    b.Connect(touched->y, localization->touched);
    b.Connect(isolated->y, localization->isolated);
    diagram.emplace(b.Build());
    sim.emplace(*diagram);
  }

  void MoveTo(const JointPosition& posture) {
    sim->Set(q->value, posture);
    sim->Set(measured->value, posture);
  }
  RobotDynamics At(const JointPosition& posture) const {
    RobotDynamics d(model);
    ComputeDynamics(model, posture, JointVelocity::Zero(model.joints()), d);
    return d;
  }
  /// A push of 20 N at the point of a link's surface that is nearest to one in the world, along the
  /// inward normal.
  ContactForce PushAt(const std::string& link, const Vector3d& near,
                      const JointPosition& posture) const {
    const RobotSurface surface(model);
    std::vector<Solid> placed = surface.Solids();
    const RobotDynamics d = At(posture);
    surface.Place(d, Pose(), 0, placed);
    const int index = model.link_index(link);
    const SurfacePoint on = surface.NearestOnLink(index, placed, near);
    const Pose X = LinkPose(model, d, index);
    return {index, X.rotation.transpose() * (on.point - X.position), -20 * on.normal,
            Vector3d::Zero()};
  }
  Vector3d InWorld(const ContactForce& contact, const JointPosition& posture) const {
    const RobotDynamics d = At(posture);
    const Pose X = LinkPose(model, d, contact.link);
    return X.position + X.rotation * contact.point;
  }
  void Look(int pictures = 1) {
    for (int k = 0; k < pictures; ++k) sim->AdvanceThroughTick();
  }
  const Contacts& found() { return sim->Get(localization->contacts); }
  const ContactSight& sight() { return sim->Get(localization->sight); }

  RobotModel model;
  DiagramBuilder b;
  DepthCamera* camera;
  ContactLocalization* localization;
  Constant<JointPosition>*q, *measured;
  Constant<JointVelocity>* still;
  Constant<bool>* touched;
  Constant<int>* isolated;
  std::array<Constant<ContactForce>*, 3> push;
  std::optional<Diagram> diagram;
  std::optional<Simulator> sim;
};

/// All points of a hand's ball are within its radius of the normal it touches on, so their mean is.
constexpr double kHand = 0.04;

const Pose kBeside = LookingAt({-0.3, 1.7, 0.8}, {-0.3, 0, 0.5});

TEST(ContactLocalization, FindsNothingOnAnArmThatNobodyTouches) {
  Rig rig;
  RandomStates random(rig.model, 21);
  long points = 0;
  for (int k = 0; k < 200; ++k) {
    rig.MoveTo(random.q());
    rig.Look();
    EXPECT_EQ(rig.found().count(), 0) << k;
    EXPECT_TRUE(rig.sight().unseen);
    points += rig.sight().points;
  }
  // Of some 15 000 pixels that see the arm, one in 740 reads more than 3 σ too near: 20 a picture,
  // and those at flat angles, where σ is larger than the filter takes it for.
  RecordProperty("points_per_picture", static_cast<double>(points) / 200);
  EXPECT_LT(points, 200 * 60);
}

TEST(ContactLocalization, FindsNothingOnObstaclesItKnows) {
  const std::vector<Obstacle> table{
      BoxObstacle{.name = "table", .center = {-0.4, 0, 0.05}, .size = {0.4, 1, 0.06}},
      SphereObstacle{.name = "post", .center = {-0.3, 0.25, 0.45}, .radius = 0.1}};
  ContactLocalization::Options o{.model = Lwr(), .obstacles = table};
  Rig known(kBeside, {}, o, table);
  known.Look();
  EXPECT_EQ(known.found().count(), 0);
}

TEST(ContactLocalization, FindsNoHandThatHovers) {
  Rig rig(kBeside);
  // The hand touches at the end of a force that is not on the surface: 10 cm off.
  ContactForce push = rig.PushAt("link_5", {-0.3, 1, 0.6}, kStart);
  const RobotDynamics d = rig.At(kStart);
  const Pose X = LinkPose(rig.model, d, push.link);
  const Vector3d out = -X.rotation.transpose() * push.force.normalized();
  ContactForce hover = push;
  hover.point += 0.10 * out;
  hover.force = X.rotation * out.cross(Vector3d::UnitZ()).normalized() * 20;
  rig.sim->Set(rig.push[0]->value, hover);
  rig.Look();
  EXPECT_EQ(rig.found().count(), 0);
  rig.sim->Set(rig.push[0]->value, push);
  rig.Look();
  EXPECT_EQ(rig.found().count(), 1);
}

TEST(ContactLocalization, FindsAContactWithinHalfAHand) {
  Rig rig(kBeside);
  // Pushed from the camera's side, where no other link is near.
  for (const char* link : {"link_3", "link_4", "link_5", "link_6"}) {
    const ContactForce push = rig.PushAt(link, {-0.3, 1.5, 0.6}, kStart);
    rig.sim->Set(rig.touched->value, false);
    rig.Look();
    EXPECT_EQ(rig.found().count(), 0);
    rig.sim->Set(rig.touched->value, true);
    rig.sim->Set(rig.push[0]->value, push);
    rig.Look();
    ASSERT_EQ(rig.found().count(), 1) << link;
    const ContactForce& found = rig.found().at[0];
    EXPECT_LT((rig.InWorld(found, kStart) - rig.InWorld(push, kStart)).norm(), kHand) << link;
    EXPECT_EQ(found.force, Vector3d::Zero());
    EXPECT_TRUE(rig.sight().seen[0]);
    EXPECT_FALSE(rig.sight().unseen);
    EXPECT_EQ(rig.sight().age, 0);
    // On the surface.
    const RobotSurface surface(rig.model);
    std::vector<Solid> placed = surface.Solids();
    surface.Place(rig.At(kStart), Pose(), 0, placed);
    EXPECT_NEAR(surface.NearestOnLink(found.link, placed, rig.InWorld(found, kStart)).distance, 0,
                1e-12);
  }
}

TEST(ContactLocalization, FindsTwoHandsAndEachKeepsItsPlace) {
  Rig rig(kBeside);
  const ContactForce low = rig.PushAt("link_3", {-0.1, 1.5, 0.4}, kStart);
  const ContactForce high = rig.PushAt("link_6", {-0.6, 1.5, 0.5}, kStart);
  rig.sim->Set(rig.push[1]->value, high);
  rig.Look(2);
  ASSERT_EQ(rig.found().count(), 1);
  rig.sim->Set(rig.push[0]->value, low);
  rig.Look();
  ASSERT_EQ(rig.found().count(), 2);
  EXPECT_LT((rig.InWorld(rig.found().at[0], kStart) - rig.InWorld(high, kStart)).norm(), kHand);
  EXPECT_LT((rig.InWorld(rig.found().at[1], kStart) - rig.InWorld(low, kStart)).norm(), kHand);
  // The first lets go: its place is free after three pictures, the other keeps its own.
  rig.sim->Set(rig.push[1]->value, ContactForce());
  rig.Look(2);
  EXPECT_EQ(rig.found().count(), 2);
  EXPECT_FALSE(rig.sight().seen[0]);
  rig.Look();
  EXPECT_EQ(rig.found().at[0].link, -1);
  EXPECT_EQ(rig.found().at[1].link, rig.model.link_index("link_3"));
  EXPECT_TRUE(rig.sight().seen[1]);
}

TEST(ContactLocalization, TakesReadingsThatAreNoNumbersForNone) {
  // The same pictures, with 0, NaN, ±∞ or −1 m in every third pixel.
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<float> none{0, std::numeric_limits<float>::quiet_NaN(), inf, -inf, -1};
  ContactLocalization::Options o{.model = Lwr()};
  Rig rig(kBeside);
  o.view.pose = kBeside;
  rig.sim->Set(rig.push[0]->value, rig.PushAt("link_5", {-0.3, 1.5, 0.6}, kStart));
  rig.Look();
  DepthImage image = rig.sim->Get(rig.camera->image);
  const RobotDynamics d = rig.At(kStart);
  std::vector<Contacts> found;
  for (const float reading : none) {
    BlockTester<ContactLocalization> t(o);
    for (std::size_t i = 0; i < image.depth.size(); i += 3) image.depth[i] = reading;
    image.time = t.time();
    t.Set(t->image, image);
    t.Set(t->dynamics, d);
    t.Tick();
    found.push_back(t.Get(t->contacts));
    EXPECT_EQ(found.back().count(), 1) << reading;
    EXPECT_EQ(found.back().at[0].point, found.front().at[0].point) << reading;
  }
}

TEST(ContactLocalization, FindsNoMoreContactsThanItIsToldOf) {
  ContactLocalization::Options o{.model = Lwr()};
  o.contacts = 1;
  Rig rig(kBeside, {}, o);
  rig.sim->Set(rig.push[0]->value, rig.PushAt("link_3", {-0.1, 1.5, 0.4}, kStart));
  rig.sim->Set(rig.push[1]->value, rig.PushAt("link_6", {-0.6, 1.5, 0.5}, kStart));
  rig.Look(3);
  EXPECT_EQ(rig.found().count(), 1);
}

TEST(ContactLocalization, FollowsTheArmAndWhatMovesOnIt) {
  Rig rig(kBeside);
  const ContactForce push = rig.PushAt("link_5", {-0.3, 1.5, 0.6}, kStart);
  JointPosition posture = kStart;
  for (int k = 0; k < 60; ++k) {
    posture = kStart + JointPosition(0.25 * std::sin(0.1 * k) * PerJoint::Ones(7));
    rig.MoveTo(posture);
    ContactForce now = push;
    const Pose before = LinkPose(rig.model, rig.At(kStart), push.link);
    const Pose X = LinkPose(rig.model, rig.At(posture), push.link);
    now.force = X.rotation * before.rotation.transpose() * push.force;
    rig.sim->Set(rig.push[0]->value, now);
    rig.Look();
    ASSERT_EQ(rig.found().count(), 1) << k;
    EXPECT_EQ(rig.found().at[0].link, push.link) << k;
    EXPECT_LT((rig.InWorld(rig.found().at[0], posture) - rig.InWorld(now, posture)).norm(), kHand)
        << k;
  }
}

TEST(ContactLocalization, KeepsAContactThatABodyHides) {
  // Seen first; then the arm turns so that the hand is behind it.
  Rig rig(LookingAt({1.7, 0, 1.0}, {0, 0, 0.8}));
  const JointPosition upright = JointPosition::Zero(rig.model.joints());
  rig.MoveTo(upright);
  const ContactForce push = rig.PushAt("link_5", {1.5, 0, 0.9}, upright);
  rig.sim->Set(rig.push[0]->value, push);
  rig.Look();
  ASSERT_EQ(rig.found().count(), 1);
  const ContactForce known = rig.found().at[0];
  JointPosition turned = upright;
  turned(0) = 2.9;
  rig.MoveTo(turned);
  ContactForce now = push;
  const Eigen::Matrix3d R = LinkPose(rig.model, rig.At(turned), push.link).rotation;
  now.force = R * push.force;
  rig.sim->Set(rig.push[0]->value, now);
  rig.Look();
  EXPECT_FALSE(rig.sight().seen[0]);
  rig.Look(10);
  ASSERT_EQ(rig.found().count(), 1);
  EXPECT_EQ(rig.found().at[0].link, known.link);
  EXPECT_EQ(rig.found().at[0].point, known.point);
  rig.sim->Set(rig.touched->value, false);
  rig.Look();
  EXPECT_EQ(rig.found().count(), 0);
  EXPECT_FALSE(rig.sight().unseen);
}

TEST(ContactLocalization, SaysThatAHandBehindTheArmIsNotSeen) {
  Rig rig(LookingAt({1.7, 0, 0.9}, {0, 0, 0.9}));
  rig.MoveTo(JointPosition::Zero(rig.model.joints()));
  const ContactForce push =
      rig.PushAt("link_5", {-1.5, 0, 0.9}, JointPosition::Zero(rig.model.joints()));
  rig.sim->Set(rig.push[0]->value, push);
  rig.Look(3);
  EXPECT_EQ(rig.found().count(), 0);
  EXPECT_TRUE(rig.sight().unseen);
}

TEST(ContactLocalization, TakesNoContactBeforeTheIsolatedLink) {
  Rig rig(kBeside);
  const ContactForce low = rig.PushAt("link_3", {-0.1, 1.5, 0.4}, kStart);
  const ContactForce high = rig.PushAt("link_6", {-0.6, 1.5, 0.5}, kStart);
  rig.sim->Set(rig.push[0]->value, low);
  rig.sim->Set(rig.isolated->value, rig.model.link_index("link_5"));
  rig.Look(2);
  EXPECT_EQ(rig.found().count(), 0);
  EXPECT_TRUE(rig.sight().unseen);
  // With one behind it too, it may be touched in both places.
  rig.sim->Set(rig.push[1]->value, high);
  rig.Look(2);
  EXPECT_EQ(rig.found().count(), 2);
}

TEST(ContactLocalization, LooksAtNoPictureTwiceNorAtAnOldOneNorOfAnotherSize) {
  ContactLocalization::Options o{.model = Lwr()};
  BlockTester<ContactLocalization> t(o);
  DepthImage image(640, 480);
  std::ranges::fill(image.depth, 1.7f);
  RobotDynamics d(o.model);
  ComputeDynamics(o.model, kStart, JointVelocity::Zero(o.model.joints()), d);
  t.Set(t->dynamics, d);
  t.Set(t->image, DepthImage(320, 240));
  t.Tick();
  EXPECT_EQ(t.Get(t->sight).age, -1);
  image.time = t.time();
  t.Set(t->image, image);
  t.Tick();  // the picture is of the tick before
  EXPECT_NEAR(t.Get(t->sight).age, 1 / 30.0, 1e-8);
  t.Tick();
  EXPECT_NEAR(t.Get(t->sight).age, 2 / 30.0, 1e-8);
  image.time = t.time() - 0.05;
  t.Set(t->image, image);
  t.Tick();
  EXPECT_NEAR(t.Get(t->sight).age, 3 / 30.0, 1e-8);
}

TEST(ContactLocalization, RunsWithoutHeapAndTheSameAgainAfterARestore) {
  Rig rig(kBeside);
  rig.sim->Set(rig.push[0]->value, rig.PushAt("link_5", {-0.3, 1.5, 0.6}, kStart));
  rig.Look();
  const Context snapshot = rig.sim->Snapshot();
  const long before = Allocations();
  rig.Look(5);
  EXPECT_EQ(Allocations(), before);
  const Context end = rig.sim->Snapshot();
  rig.sim->Restore(snapshot);
  rig.Look(5);
  EXPECT_TRUE(rig.sim->Snapshot() == end);
}

TEST(ContactLocalization, StaysFiniteWhateverItIsGiven) {
  ContactLocalization::Options o{.model = Lwr()};
  BlockTester<ContactLocalization> t(o);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-10, 10);
  const float inf = std::numeric_limits<float>::infinity();
  const std::array<float, 3> no_numbers{std::numeric_limits<float>::quiet_NaN(), inf, -inf};
  DepthImage image(640, 480);
  RobotDynamics d(o.model);
  for (int k = 0; k < 20; ++k) {
    for (float& z : image.depth) z = static_cast<float>(number(random));
    for (std::size_t i = 0; i < image.depth.size(); i += 7) image.depth[i] = no_numbers[i % 3];
    for (BodyMotion& body : d.body) {
      body.rotation = Eigen::Matrix3d::NullaryExpr([&] { return number(random); });
      body.position = Vector3d::NullaryExpr([&] { return number(random); });
    }
    image.time = t.time();
    t.Set(t->image, image);
    t.Set(t->dynamics, d);
    t.Tick();
    for (const ContactForce& contact : t.Get(t->contacts).at)
      EXPECT_TRUE(contact.point.allFinite());
    t.Set(t->isolated, k - 3);
  }
}

TEST(ContactLocalization, RefusesOptionsOutOfTheirRange) {
  const auto refused = [](auto&& change) {
    ContactLocalization::Options o{.model = Lwr()};
    change(o);
    return ErrorOf([&] { BlockTester<ContactLocalization> t(o); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused([](auto& o) { o.reach = 0; }), HasSubstr("reach must be > 0 m, got 0"));
  EXPECT_THAT(refused([](auto& o) { o.smoothing = 2; }),
              HasSubstr("smoothing must be from 0.001 to 1, got 2"));
  EXPECT_THAT(refused([](auto& o) { o.contacts = 4; }),
              HasSubstr("contacts must be from 1 to 3, got 4"));
  EXPECT_THAT(refused([](auto& o) { o.view.width = -1; }),
              HasSubstr("view.width must be from 1 to 4096 px, got -1"));
  EXPECT_THAT(refused([](auto& o) { o.view.height = 0; }),
              HasSubstr("view.height must be from 1 to 4096 px, got 0"));
  EXPECT_THAT(refused([](auto& o) { o.margin = -1; }), HasSubstr("margin must be >= 0 m, got -1"));
}

}  // namespace
}  // namespace pliant
