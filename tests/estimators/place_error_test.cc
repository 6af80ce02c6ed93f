#include "pliant/estimators/place_error.h"

#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

struct Rig {
  Rig() {
    ComputeDynamics(model, RandomStates(model, 3).q(), JointVelocity::Zero(model.joints()), d);
  }

  /// A contact with link 4 at a point in the world.
  ContactForce At(const Vector3d& x, const Vector3d& force) const {
    const int link = model.link_index("link_4");
    const Pose X = LinkPose(model, d, link);
    return {link, X.rotation.transpose() * (x - X.position), force, Vector3d::Zero()};
  }
  double Of(const Contacts& places, const Contacts& truth) {
    t.Set(t->places, places);
    t.Set(t->true_contacts, truth);
    t.Set(t->dynamics, d);
    return t.Get(t->distance);
  }

  RobotModel model = Lwr();
  RobotDynamics d{model};
  BlockTester<PlaceError> t{PlaceError::Options{.model = model}};
};

TEST(PlaceError, IsTheDistanceToTheLineOfTheForce) {
  Rig rig;
  Contacts places, truth;
  EXPECT_EQ(rig.Of(places, truth), 0);
  places.at[1] = rig.At({0.1, 0.2, 0.3}, Vector3d::Zero());
  EXPECT_EQ(rig.Of(places, truth), 0);  // nothing to compare with
  truth.at[0] = rig.At({0.1, 0.2, 0.9}, {0, 0, -20});
  EXPECT_NEAR(rig.Of(places, truth), 0, 1e-14);
  truth.at[0] = rig.At({0.13, 0.24, 0.9}, {0, 0, 7});
  EXPECT_NEAR(rig.Of(places, truth), 0.05, 1e-14);
}

TEST(PlaceError, IsThatOfTheWorstPlaceToItsNearestForce) {
  Rig rig;
  Contacts places, truth;
  places.at[0] = rig.At({0, 0, 0}, Vector3d::Zero());
  places.at[2] = rig.At({1, 0, 0}, Vector3d::Zero());
  truth.at[0] = rig.At({1, 0.02, 0}, {0, 0, 1});
  truth.at[1] = rig.At({0, 0.01, 0}, {0, 0, 1});
  EXPECT_NEAR(rig.Of(places, truth), 0.02, 1e-14);
}

TEST(PlaceError, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<PlaceError>(PlaceError::Options{.model = Lwr()}));
}

}  // namespace
}  // namespace pliant
