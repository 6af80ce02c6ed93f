#include "pliant/estimators/contact_detection.h"

#include <gtest/gtest.h>

#include <span>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

ContactDetection::Options Options(const RobotModel& m) {
  return {
      .model = m, .period = 1ms, .threshold = PerJoint::LinSpaced(m.size(), 2, 1), .release = 0.5};
}

struct Rig {
  explicit Rig(const RobotModel& m) : model{m}, t{Options(m)} {}

  void Feel(const JointTorque& r) {
    t.Set(t->residual, r);
    t.Tick();
  }
  bool touched() { return t.Get(t->touched); }
  int link() { return t.Get(t->link); }

  RobotModel model;
  BlockTester<ContactDetection> t;
};

JointTorque Only(const RobotModel& m, int joint, double torque) {
  JointTorque r = JointTorque::Zero(m.joints());
  r(joint) = torque;
  return r;
}

TEST(ContactDetection, BeginsAboveAThresholdAndEndsBelowAShareOfIt) {
  Rig rig(Lwr());
  for (int i = 0; i < 7; ++i) {
    const double c = Options(rig.model).threshold(i);
    for (const double sign : {1.0, -1.0}) {
      rig.Feel(Only(rig.model, i, sign * c));
      EXPECT_FALSE(rig.touched()) << "at the threshold";
      rig.Feel(Only(rig.model, i, sign * c * 1.01));
      EXPECT_TRUE(rig.touched());
      EXPECT_EQ(rig.t.Get(rig.t->felt), 1U << i);
      EXPECT_NEAR(rig.t.Get(rig.t->level), 1.01, 1e-12);
      rig.Feel(Only(rig.model, i, -sign * c * 0.5));
      EXPECT_TRUE(rig.touched()) << "on the way down";
      rig.Feel(Only(rig.model, i, sign * c * 0.49));
      EXPECT_FALSE(rig.touched());
      EXPECT_EQ(rig.link(), -1);
    }
  }
}

TEST(ContactDetection, NamesALinkThatTheContactIsOnOrBeyond) {
  for (const RobotModel& m : {Lwr(), Gen3()}) {
    Rig rig(m);
    RandomStates random(m, 71);
    int exact = 0, felt = 0;
    for (int k = 0; k < 300; ++k) {
      RobotDynamics d(m);
      ComputeDynamics(m, random.q(), JointVelocity::Zero(m.joints()), d);
      const int joint = static_cast<int>(random.random() % 7);
      const ContactForce F{m.joint(joint).child, random.Uniform(0.2).head<3>(),
                           random.Uniform(40).head<3>(), Eigen::Vector3d::Zero()};
      rig.Feel(JointTorque::Zero(m.joints()));
      rig.Feel(ExternalTorque(m, d, std::span(&F, 1)));
      if (!rig.touched()) continue;
      ++felt;
      int named = 0;
      while (m.joint(named).child != rig.link()) ++named;
      EXPECT_LE(named, joint) << "joints beyond a contact feel nothing of it";
      exact += named == joint;
    }
    EXPECT_GT(felt, 200);
    EXPECT_GT(exact, felt / 2) << "and mostly its own joint does";
    EXPECT_LT(exact, felt) << "but not always";
  }
}

TEST(ContactDetection, DoesNotSeeAForceThroughTheAxesOfAllJointsThatCarryIt) {
  Rig rig(Lwr());
  const RobotModel& m = rig.model;
  RobotDynamics d(m);
  ComputeDynamics(m, JointPosition::Zero(m.joints()), JointVelocity::Zero(m.joints()), d);
  // Upright, 500 N down on the flange meets every axis or is parallel to it.
  const ContactForce F{m.joint(6).child, {0, 0, 0}, {0, 0, -500}, Eigen::Vector3d::Zero()};
  rig.Feel(ExternalTorque(m, d, std::span(&F, 1)));
  EXPECT_FALSE(rig.touched());
}

TEST(ContactDetection, TakesTheOutermostJointOfATreeFromItsBranches) {
  Rig rig(Tree());
  const RobotModel& m = rig.model;
  JointTorque r = Only(m, m.joint_index("waist"), 10);
  r(m.joint_index("left_wrist")) = 10;  // the file names it first
  rig.Feel(r);
  EXPECT_EQ(rig.link(), m.link_index("left_hand"));
}

TEST(ContactDetection, RefusesThresholdsThatAreNone) {
  const auto error = [](auto change) {
    ContactDetection::Options o = Options(Lwr());
    change(o);
    return ErrorOf([&] { ContactDetection detection(o); });
  };
  EXPECT_EQ(error([](auto& o) { o.threshold(2) = 0; }),
            "threshold[joint_3] must be > 0 N·m, got 0");
  EXPECT_EQ(error([](auto& o) { o.threshold.conservativeResize(3); }),
            "threshold has an element for each of the 7 joints, got 3");
  EXPECT_EQ(error([](auto& o) { o.release = 1.5; }), "release must be from 0 to 1, got 1.5");
}

TEST(ContactDetection, HoldsTheLaws) {
  ExpectBlockLaws(BlockTester<ContactDetection>(Options(Lwr())));
}

}  // namespace
}  // namespace pliant
