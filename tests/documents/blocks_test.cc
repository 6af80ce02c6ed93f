#include <gtest/gtest.h>

#include "pliant/systems/block_tester.h"

namespace pliant {
namespace {

// shown: begin block
/// A spring that also learns what it has to carry, every h:
///
///   τ_k = K e_k + s_k,   s_{k+1} = s_k + K_i h e_k
class LearningSpring final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint stiffness;  ///< K [N·m/rad]; may be driven while it runs
    double learning;     ///< K_i [N·m/(rad·s)], ≥ 0
    Duration period = 1ms;
  };

  explicit LearningSpring(const Options& o)
      : error{this, "error", o.joints},
        stiffness{this, "stiffness", {}, o.stiffness},
        torque{this, "torque", o.joints},
        learned_{this, "learned", o.joints},
        gain_{o.learning * seconds(o.period)} {
    Require(o.learning >= 0, "learning must be >= 0", o.learning);
    Every(o.period).Compute(torque).From(error, stiffness, learned_).As(&LearningSpring::Law);
    Every(o.period).Update(learned_).From(learned_, error).As(&LearningSpring::Learn);
  }

  Input<JointPosition> error;
  Input<PerJoint> stiffness;
  Output<JointTorque> torque;

 private:
  JointTorque Law(const JointPosition& e, const PerJoint& K, const JointTorque& learned) const {
    return K.cwiseProduct(e) + learned;
  }
  JointTorque Learn(const JointTorque& learned, const JointPosition& e) const {
    return learned + gain_ * e;
  }

  Discrete<JointTorque> learned_;
  const double gain_;
};
// shown: end block

// shown: begin test
TEST(LearningSpring, LearnsFromOneTickToTheNext) {
  BlockTester<LearningSpring> t(
      {.joints = {"elbow"}, .stiffness = PerJoint::Constant(1, 100), .learning = 500});
  t.Set(t->error, {0.1});
  t.Tick();
  EXPECT_DOUBLE_EQ(t.Get(t->torque)(0), 100 * 0.1);
  t.Tick();
  EXPECT_DOUBLE_EQ(t.Get(t->torque)(0), 100 * 0.1 + 500 * 1e-3 * 0.1);
}
// shown: end test

TEST(LearningSpring, TakesItsStiffnessFromOutsideWhileItRuns) {
  BlockTester<LearningSpring> t(
      {.joints = {"elbow"}, .stiffness = PerJoint::Constant(1, 100), .learning = 0});
  t.Set(t->error, {0.1});
  t.Tick();
  t.Set(t->stiffness, PerJoint::Constant(1, 50));
  t.Tick();
  EXPECT_DOUBLE_EQ(t.Get(t->torque)(0), 50 * 0.1);
}

}  // namespace
}  // namespace pliant
