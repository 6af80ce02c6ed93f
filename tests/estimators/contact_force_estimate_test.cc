#include "pliant/estimators/contact_force_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <vector>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

RobotDynamics At(const RobotModel& m, const JointPosition& q) {
  RobotDynamics d(m);
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  return d;
}

/// Contacts on the links that joints move, counted from 1.
Contacts On(const RobotModel& m, RandomStates& random, const std::vector<int>& links) {
  Contacts contacts;
  for (std::size_t i = 0; i < links.size(); ++i)
    contacts.at[i] = {m.joint(links[i] - 1).child, random.Uniform(0.15).head<3>(),
                      random.Uniform(30).head<3>(), Vector3d::Zero()};
  return contacts;
}

/// J of all contacts there are, one below the other.
Eigen::MatrixXd Stacked(const RobotModel& m, const RobotDynamics& d, const Contacts& contacts) {
  Eigen::MatrixXd J(0, m.size());
  for (const ContactForce& c : contacts.at) {
    if (c.link < 0) continue;
    J.conservativeResize(J.rows() + 3, Eigen::NoChange);
    J.bottomRows(3) = PointDynamics(m, d, c.link, c.point).J.bottomRows<3>();
  }
  return J;
}

struct Rig {
  explicit Rig(const RobotModel& m, double smallest_lever = 1e-6)
      : model{m},
        t{ContactForceEstimate::Options{
            .model = m, .period = 1ms, .smallest_lever = smallest_lever}} {}

  const Contacts& Of(const RobotDynamics& d, const Contacts& places, const JointTorque& r) {
    Contacts without_forces = places;
    for (ContactForce& c : without_forces.at) c.force.setConstant(1e6);  // not read
    t.Set(t->places, without_forces);
    t.Set(t->dynamics, d);
    t.Set(t->residual, r);
    t.Tick();
    return t.Get(t->contacts);
  }
  const ContactObservability& seen() { return t.Get(t->observability); }

  RobotModel model;
  BlockTester<ContactForceEstimate> t;
};

TEST(ContactForceEstimate, IsExactForAForceThatTheJointsFeel) {
  for (const RobotModel& m : {Lwr(), Gen3()}) {
    Rig rig(m, 0.02);
    RandomStates random(m, 81);
    int observed = 0;
    for (int k = 0; k < 200; ++k) {
      const RobotDynamics d = At(m, random.q());
      const Contacts truth = On(m, random, {4 + k % 4});
      const Contacts& found = rig.Of(d, truth, ExternalTorque(m, d, truth.at));
      EXPECT_EQ(found.at[0].link, truth.at[0].link);
      EXPECT_EQ(found.at[0].point, truth.at[0].point);
      EXPECT_EQ(rig.seen().rows, 3);
      if (rig.seen().rank < 3) continue;
      ++observed;
      // Round-off of some 50 N·m over the square of the smallest lever arm.
      EXPECT_LT((found.at[0].force - truth.at[0].force).norm(), 1e-14 * 50 / (0.02 * 0.02));
    }
    EXPECT_GT(observed, 150);
  }
}

TEST(ContactForceEstimate, TellsTwoAndThreeContactsOnDifferentLinksApart) {
  const RobotModel m = Lwr();
  Rig rig(m, 0.005);
  RandomStates random(m, 82);
  int observed = 0;
  for (int k = 0; k < 300; ++k) {
    const RobotDynamics d = At(m, random.q());
    const Contacts truth = On(m, random, {3 + k % 2, 6 + k % 2});
    const JointTorque r = ExternalTorque(m, d, truth.at);
    const Contacts& found = rig.Of(d, truth, r);
    EXPECT_LE(rig.seen().rank, 6);
    if (rig.seen().rank < 6) continue;
    ++observed;
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT((found.at[i].force - truth.at[i].force).norm(), 1e-14 * 100 / (0.005 * 0.005));
  }
  EXPECT_GT(observed, 100);
  // Nine numbers of three forces are more than seven joints can tell.
  const RobotDynamics d = At(m, random.q());
  const Contacts three = On(m, random, {3, 5, 7});
  rig.Of(d, three, ExternalTorque(m, d, three.at));
  EXPECT_EQ(rig.seen().rows, 9);
  EXPECT_LE(rig.seen().rank, 7);
}

TEST(ContactForceEstimate, ExplainsOfTheResidualWhatForcesAtThePointsCan) {
  const RobotModel m = Lwr();
  RandomStates random(m, 83);
  for (const std::vector<int>& links :
       std::vector<std::vector<int>>{{1}, {2}, {3}, {5}, {7}, {2, 6}, {4, 4}, {3, 5, 7}}) {
    Rig rig(m);
    for (int k = 0; k < 50; ++k) {
      const RobotDynamics d = At(m, random.q());
      const Contacts places = On(m, random, links);
      const JointTorque r = random.tau();
      rig.Of(d, places, r);
      // Jᵀ F̂ is r projected on the range of Jᵀ, by an SVD of its own.
      const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Stacked(m, d, places).transpose(),
                                                  Eigen::ComputeThinU);
      const Eigen::VectorXd sigma = svd.singularValues();
      // Values between the round-off of the two ways have no side of their own.
      if (((sigma.array() > 1e-9) && (sigma.array() < 1e-4)).any()) continue;
      const int rank = static_cast<int>((sigma.array() > 1e-4).count());
      const Eigen::MatrixXd U = svd.matrixU().leftCols(rank);
      const Eigen::VectorXd projected = U * (U.transpose() * r);
      EXPECT_EQ(rig.seen().rank, rank);
      // ε over the square of the smallest lever arm.
      EXPECT_LT((rig.t.Get(rig.t->explained) - projected).norm(), 1e-6);
      EXPECT_LT((rig.seen().singular_values.head(rank) - sigma.head(rank)).norm(), 1e-7);
    }
  }
}

TEST(ContactForceEstimate, NamesTheDirectionsThatAreNotObservedAndHasNothingThere) {
  const RobotModel m = Lwr();
  RandomStates random(m, 84);
  for (const int link : {1, 2}) {
    Rig rig(m, 0.01);
    for (int k = 0; k < 50; ++k) {
      const RobotDynamics d = At(m, random.q());
      const Contacts truth = On(m, random, {link});
      const JointTorque r = ExternalTorque(m, d, truth.at);
      const Vector3d found = rig.Of(d, truth, r).at[0].force;
      const ContactObservability& seen = rig.seen();
      ASSERT_LE(seen.rank, link) << "a joint feels one number";
      const Eigen::MatrixXd J = Stacked(m, d, truth);
      for (int j = 0; j < 3; ++j) {
        const Vector3d u = seen.directions.col(j).head<3>();
        EXPECT_NEAR(u.norm(), 1, 1e-12);
        // Of round-off, singular values are the roots.
        EXPECT_NEAR((J.transpose() * u).norm(), seen.singular_values(j), 1e-7);
        if (j < seen.rank) {
          EXPECT_NEAR(u.dot(found), u.dot(truth.at[0].force), 1e-9);
        } else if (seen.singular_values(j) < 1e-7) {
          EXPECT_NEAR(u.dot(found), 0, 1e-9) << "of " << u.dot(truth.at[0].force);
        }
      }
      EXPECT_EQ(seen.smallest, seen.singular_values(2));
    }
  }
}

TEST(ContactForceEstimate, StaysContinuousAndBoundedWhereALeverArmVanishes) {
  // A force across the last axis of the Gen3, ever closer to it.
  const RobotModel m = Lwr();
  const double sigma = 0.05;
  Rig rig(m, sigma);
  const RobotDynamics d = At(m, JointPosition{0, 0.7, 0, -1.5, 0, 0.9, 0});
  JointTorque r = JointTorque::Zero(m.joints());
  r << 0, 1, 0, 0.5, 0, 0.2, 0;
  Vector3d last = Vector3d::Zero();
  bool first = true;
  for (double z = 0.3; z > -0.3; z -= 1e-4) {  // along link 1: its lever arms go through 0
    Contacts at;
    at.at[0] = {m.joint(1).child, {0, 0, z}, Vector3d::Zero(), Vector3d::Zero()};
    const Vector3d F = rig.Of(d, at, r).at[0].force;
    EXPECT_LE(F.norm(), r.norm() / sigma * (1 + 1e-9));
    // σ changes by the way, and F by no more than ‖r‖/σ₀² of that.
    if (!first) {
      EXPECT_LT((F - last).norm(), 3 * 1e-4 * r.norm() / (sigma * sigma));
    }
    last = F;
    first = false;
  }
}

TEST(ContactForceEstimate, HasNoContactsWhileNothingIsTouched) {
  const RobotModel m = Lwr();
  Rig rig(m);
  RandomStates random(m, 85);
  rig.t.Set(rig.t->touched, false);
  const Contacts& found = rig.Of(At(m, random.q()), On(m, random, {5, 7}), random.tau());
  EXPECT_EQ(found.count(), 0);
  EXPECT_EQ(rig.seen().rows, 0);
  EXPECT_EQ(rig.t.Get(rig.t->explained).norm(), 0);
}

TEST(ContactForceEstimate, LeavesOutContactsOnLinksThatTheModelDoesNotHave) {
  const RobotModel m = Lwr();
  Rig rig(m);
  RandomStates random(m, 86);
  Contacts places = On(m, random, {5, 7});
  places.at[0].link = 400;
  const Contacts& found = rig.Of(At(m, random.q()), places, random.tau());
  EXPECT_EQ(found.at[0].link, -1);
  EXPECT_EQ(found.count(), 1);
}

TEST(ContactForceEstimate, RefusesALeverArmThatIsNone) {
  EXPECT_EQ(ErrorOf([] {
              ContactForceEstimate estimate({.model = Lwr(), .period = 1ms, .smallest_lever = 0});
            }),
            "smallest_lever must be > 0 m, got 0");
}

TEST(ContactForceEstimate, HoldsTheLaws) {
  BlockTester<ContactForceEstimate> t(ContactForceEstimate::Options{.model = Lwr(), .period = 1ms});
  t.Set(t->dynamics, RobotDynamics(Lwr()));
  ExpectBlockLaws(std::move(t));
}

}  // namespace
}  // namespace pliant
