#include "pliant/controllers/contact_anchor.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/controllers/contact_rig.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

/// A mass whose point is where its joints say.
struct Rig {
  RobotModel model = Mass(1);
  int link = model.link_index("mass");
  BlockTester<ContactAnchor> t{
      ContactAnchor::Options{.model = model, .place = 0, .period = 1ms, .same_point = 0.05}};
  Contacts contacts;

  const AnchoredContact& At(double x) {
    RobotDynamics d(model);
    ComputeDynamics(model, JointPosition{x, 0, 0}, JointVelocity::Zero(model.joints()), d);
    t.Set(t->dynamics, d);
    t.Set(t->contacts, contacts);
    t.Tick();
    return t.Get(t->contact);
  }
  void Touch(std::size_t place, int at_link, const Vector3d& point = Vector3d::Zero()) {
    contacts.at[place] = {at_link, point, {1, 2, 3}, Vector3d::Zero()};
  }
  void Release(std::size_t place) { contacts.at[place] = {}; }
};

TEST(ContactAnchor, IsWhereThePointWasWhenContactBegan) {
  Rig rig;
  EXPECT_EQ(rig.At(0.1).link, -1);
  rig.Touch(0, rig.link, {0, 0, 0.5});
  EXPECT_TRUE(rig.At(0.2).begins);
  EXPECT_EQ(rig.At(0.3).anchor, Vector3d(0.2, 0, 0.5));
  EXPECT_FALSE(rig.At(0.4).begins);
  EXPECT_TRUE(rig.At(0.4).touched);
  EXPECT_EQ(rig.At(0.4).force, Vector3d(1, 2, 3));
  EXPECT_LT((rig.t.Get(rig.t->error) - Vector3d(-0.2, 0, 0)).norm(), 1e-15);
}

TEST(ContactAnchor, KeepsThePointAfterTheReleaseAndWhenItIsTouchedAgain) {
  Rig rig;
  rig.Touch(0, rig.link);
  rig.At(0.2);
  rig.Release(0);
  const AnchoredContact released = rig.At(0.3);
  EXPECT_FALSE(released.touched);
  EXPECT_EQ(released.link, rig.link);
  EXPECT_EQ(released.anchor, Vector3d(0.2, 0, 0));
  EXPECT_EQ(released.force, Vector3d(Vector3d::Zero()));
  rig.Touch(0, rig.link, {0.04, 0, 0});
  const AnchoredContact again = rig.At(0.35);
  EXPECT_TRUE(again.begins);
  EXPECT_EQ(again.anchor, Vector3d(0.2, 0, 0)) << "pushes do not carry the arm along";
}

TEST(ContactAnchor, StaysWithThePointWhileItsLocalisationWanders) {
  Rig rig;
  rig.Touch(0, rig.link);
  rig.At(0.2);
  rig.Touch(0, rig.link, {0.03, -0.03, 0.01});
  EXPECT_EQ(rig.At(0.2).point, Vector3d(Vector3d::Zero()));
  EXPECT_FALSE(rig.At(0.2).begins);
  rig.Touch(0, rig.link, {0.06, 0, 0});
  const AnchoredContact moved = rig.At(0.2);
  EXPECT_TRUE(moved.begins) << "elsewhere is another contact";
  EXPECT_EQ(moved.anchor, Vector3d(0.26, 0, 0));
}

TEST(ContactAnchor, BeginsAnewOnAnotherLink) {
  Rig rig;
  rig.Touch(0, rig.link);
  rig.At(0.2);
  rig.Touch(0, rig.model.link_index("first"));
  const AnchoredContact now = rig.At(0.5);
  EXPECT_TRUE(now.begins);
  EXPECT_EQ(now.link, rig.model.link_index("first"));
  EXPECT_EQ(now.anchor, Vector3d(0.5, 0, 0));
}

TEST(ContactAnchor, LetsAReleasedPointGoWhenAnotherPlaceIsTouched) {
  Rig rig;
  rig.Touch(0, rig.link);
  rig.At(0.2);
  rig.Touch(1, rig.link, {1, 0, 0});
  EXPECT_EQ(rig.At(0.2).link, rig.link) << "both are touched";
  rig.Release(1);
  rig.Release(0);
  EXPECT_EQ(rig.At(0.2).link, rig.link);
  rig.Touch(1, rig.link, {1, 0, 0});
  EXPECT_EQ(rig.At(0.2).link, -1);
}

TEST(ContactAnchor, TakesALinkThatTheModelDoesNotHaveForNone) {
  Rig rig;
  rig.Touch(0, 44);
  EXPECT_FALSE(rig.At(0).touched);
  EXPECT_EQ(rig.At(0).link, -1);
}

TEST(ContactAnchor, RefusesAPlaceThatThereIsNot) {
  EXPECT_EQ(ErrorOf([] { ContactAnchor anchor({.model = Lwr(), .place = 3, .period = 1ms}); }),
            "place must be from 0 to 2, got 3");
  EXPECT_EQ(
      ErrorOf([] { ContactAnchor anchor({.model = Lwr(), .period = 1ms, .same_point = -1}); }),
      "same_point must be >= 0 m, got -1");
}

TEST(ContactAnchor, HoldsTheLaws) {
  BlockTester<ContactAnchor> t(ContactAnchor::Options{.model = Lwr(), .place = 1, .period = 1ms});
  t.Set(t->dynamics, RobotDynamics(Lwr()));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
