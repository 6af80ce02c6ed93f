#include "pliant/estimators/interaction_estimator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kPeriod = 1e-3;

InteractionEstimator::Options Options() {
  static const RobotModel m = Lwr();
  return {.model = m, .memory_s = 0.05, .prior = 2, .period = 1ms};
}

/// Dynamics of an arm at q whose momentum is p, and which nothing else acts on.
RobotDynamics With(const JointPosition& q, const PerJoint& p) {
  const RobotModel m = Options().model;
  RobotDynamics d(m);
  ComputeDynamics(m, q, JointVelocity::Zero(m.joints()), d);
  d.p = p;
  d.coriolis_transposed.setZero();
  d.gravity.setZero();
  return d;
}

void Sample(BlockTester<InteractionEstimator>& t, const RobotDynamics& d, const JointTorque& tau) {
  t.Set(t->dynamics, d);
  t.Set(t->torque, tau);
  t.Tick();
}

TEST(InteractionEstimator, FindsAConstantTorqueAsTheClosedFormSays) {
  const InteractionEstimator::Options o = Options();
  RandomStates random(o.model, 61);
  BlockTester<InteractionEstimator> t(o);
  const JointTorque tau_e = random.tau(), tau = random.tau();
  const JointPosition q = random.q();
  const double lambda = std::exp(-kPeriod / 0.05);
  for (int k = 0; k <= 400; ++k) {
    Sample(t, With(q, k * kPeriod * (tau + PerJoint(tau_e))), tau);
    const double s = (1 - std::pow(lambda, k)) / (1 - lambda);  // Σ λ^i of k samples
    // Round-off of p, 20 N·m·s, over h.
    ASSERT_LT((t.Get(t->external_torque) - s / (s + 2) * tau_e).norm(), 1e-10) << k;
    ASSERT_NEAR(t.Get(t->information)(3, 3), s + 2, 1e-10);
  }
  EXPECT_EQ(t.Get(t->force).norm(), 0);
}

TEST(InteractionEstimator, IsLateByItsMemoryOfATorqueThatRisesSlowly) {
  InteractionEstimator::Options o = Options();
  o.prior = 1e-6;
  RandomStates random(o.model, 62);
  BlockTester<InteractionEstimator> t(o);
  const PerJoint slope = random.tau();
  const JointPosition q = random.q();
  double s = 0;
  for (int k = 0; k <= 1500; ++k) {
    s = k * kPeriod;
    Sample(t, With(q, 0.5 * s * s * slope), JointTorque::Zero(o.model.joints()));
  }
  // Samples are means over h, and their weights λ^i have the mean age λ/(1 − λ).
  const double lambda = std::exp(-kPeriod / 0.05);
  const double age = kPeriod * (0.5 + lambda / (1 - lambda));
  EXPECT_LT((t.Get(t->external_torque) - (s - age) * slope).norm(), 1e-6 * slope.norm());
}

TEST(InteractionEstimator, FindsAForceAtAPoint) {
  InteractionEstimator::Options o = Options();
  o.at = {.link = "link_6", .point = {0.02, 0.01, 0.05}};
  o.prior = 1e-4;
  RandomStates random(o.model, 63);
  BlockTester<InteractionEstimator> t(o);
  const JointPosition q = random.q();
  const RobotDynamics d = With(q, PerJoint::Zero(7));
  const Vector3d F(12, -5, 8);
  const PerJoint tau_e = PointDynamics(o.model, d, o.model.link_index("link_6"), o.at->point)
                             .J.bottomRows<3>()
                             .transpose() *
                         F;
  for (int k = 0; k <= 500; ++k) Sample(t, With(q, k * kPeriod * tau_e), PerJoint::Zero(7));
  // Of F a part r₀/(r₀ + 50 σ²) is missing, σ the singular values of J_c, here above 0.1.
  EXPECT_LT((Vector3d(t.Get(t->force)) - F).norm(), 1e-3 * F.norm());
  EXPECT_LT((t.Get(t->external_torque) - tau_e).norm(), 1e-3 * tau_e.norm());
}

// The origin of link_4 lies on the axis of joint 3: nothing there tells of a force along it.
TEST(InteractionEstimator, DoesNotWindUpWithoutExcitation) {
  InteractionEstimator::Options o = Options();
  o.at = {.link = "link_4"};
  RandomStates random(o.model, 64);
  BlockTester<InteractionEstimator> t(o);
  const JointPosition q = random.q();
  double largest = 0;
  for (int k = 0; k <= 3000; ++k) {  // 60 times its memory
    Sample(t, With(q, random.Uniform(1e-3)), PerJoint::Zero(7));
    const Eigen::Matrix3d R = t.Get(t->information);
    const Vector3d eigen = R.selfadjointView<Eigen::Lower>().eigenvalues();
    ASSERT_GE(eigen(0), 2 * (1 - 1e-12));  // R ⪰ r₀ I
    largest = std::max(largest, t.Get(t->force).norm());
    if (k == 3000) {
      EXPECT_NEAR(eigen(0), 2, 1e-9);
    }
  }
  // θ = R⁻¹ z: noise of ±2 N·m in each y, ‖J_c‖ ≤ 0.57 m, Σ λ^i ≤ 51, 1/r₀ ≤ 1/2.
  EXPECT_LT(largest, std::sqrt(7.0) * 2 * 0.57 * 51 / 2);
}

TEST(InteractionEstimator, TakesRotorsOffTheMomentum) {
  InteractionEstimator::Options o = Options();
  RandomStates random(o.model, 65);
  BlockTester<InteractionEstimator> links(o);
  o.rotor_inertia = random.Uniform(1).cwiseAbs();
  BlockTester<InteractionEstimator> all(o);
  for (int k = 0; k < 50; ++k) {
    RobotDynamics d(o.model);
    ComputeDynamics(o.model, random.q(), random.v(), d);
    const JointTorque tau = random.tau();
    Sample(links, d, tau);
    d.p += o.rotor_inertia.cwiseProduct(d.v);
    Sample(all, d, tau);
    // Round-off of p over h, some thousands of N·m in all.
    ASSERT_LT((all.Get(all->external_torque) - links.Get(links->external_torque)).norm(), 1e-9);
  }
}

TEST(InteractionEstimator, RunsTheSameAgainOffTheHeap) {
  InteractionEstimator::Options o = Options();
  for (const bool at : {false, true}) {
    if (at) o.at = {.link = "link_4"};
    BlockTester<InteractionEstimator> t(o);
    const auto run = [&] {
      RandomStates random(o.model, 66);
      long allocations = 0;
      for (int k = 0; k < 50; ++k) {
        RobotDynamics d(o.model);
        ComputeDynamics(o.model, random.q(), random.v(), d);
        t.Set(t->dynamics, d);
        t.Set(t->torque, random.tau());
        const long before = Allocations();
        t.Tick();
        allocations += Allocations() - before;
        EXPECT_TRUE(t.Get(t->external_torque).allFinite());
      }
      EXPECT_EQ(allocations, 0);
      return t.Get(t->external_torque);
    };
    t.Set(t->dynamics, With(JointPosition::Zero(o.model.joints()), PerJoint::Zero(7)));
    t.Set(t->torque, PerJoint::Zero(7));
    t.Tick();
    const Context start = t.simulator().Snapshot();
    const JointTorque first = run();
    t.simulator().Restore(start);
    EXPECT_EQ(run(), first);
  }
}

TEST(InteractionEstimator, RefusesOptionsOutOfRange) {
  using testing::HasSubstr;
  const auto error = [](auto change) {
    InteractionEstimator::Options o = Options();
    change(o);
    return ErrorOf([&] { InteractionEstimator block(o); });
  };
  EXPECT_THAT(error([](auto& o) { o.memory_s = 0; }), HasSubstr("memory_s must be"));
  EXPECT_THAT(error([](auto& o) { o.prior = 0; }), HasSubstr("prior must be"));
  EXPECT_THAT(error([](auto& o) { o.at = {.link = "link_44"}; }), HasSubstr("link_4"));
  EXPECT_THAT(error([](auto& o) {
                o.at = {.link = "link_4", .point = {kToBeGiven, 0, 0}};
              }),
              HasSubstr("at.point must be finite"));
  EXPECT_THAT(error([](auto& o) { o.rotor_inertia = PerJoint::Constant(7, -1); }),
              HasSubstr("rotor_inertia"));
}

}  // namespace
}  // namespace pliant
