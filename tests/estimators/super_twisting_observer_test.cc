#include "pliant/estimators/super_twisting_observer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kPeriod = 1e-3;

/// Feeds an observer the momentum of an arm at rest on which a torque acts that is τ_e,k over
/// sample k.
class Pushed {
 public:
  explicit Pushed(double rate)
      : model_{Gen3()},
        observer_({.joints = model_.joints(), .rate = PerJoint::Constant(7, rate), .period = 1ms}),
        p_{PerJoint::Zero(7)} {
    Tick(PerJoint::Zero(7));
  }

  PerJoint Tick(const PerJoint& tau_e) {
    p_ += kPeriod * tau_e;
    RobotDynamics d(model_);
    d.p = p_;
    d.coriolis_transposed.setZero();
    d.gravity.setConstant(3);
    observer_.Set(observer_->dynamics, d);
    observer_.Set(observer_->torque, JointTorque(PerJoint::Constant(7, 3)));
    observer_.Tick();
    return observer_.Get(observer_->residual);
  }

 private:
  const RobotModel model_;
  BlockTester<SuperTwistingObserver> observer_;
  PerJoint p_;
};

// σ_k = τ̄_k, with nothing but the round-off of p over h.
TEST(SuperTwistingObserver, FollowsATorqueWithinItsRateWithoutLag) {
  Pushed arm(100);
  double worst = 0;
  for (int k = 1; k <= 3000; ++k) {
    const PerJoint tau_e = PerJoint::LinSpaced(7, 0.3, 1) * 20 * std::sin(5 * k * kPeriod);
    worst = std::max(worst, (arm.Tick(tau_e) - tau_e).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst, 1e-12 / kPeriod);  // ε · some N·m·s, over h
}

// A step asks for more than the rate: σ rises by no more than h k₃ a sample, comes to rest in
// finite time and stays there to round-off. Its way is that of the implicit rule, solved here by
// bisection.
TEST(SuperTwistingObserver, FindsAStepInFiniteTimeByTheImplicitRule) {
  const double L = 100, k1 = 1.5 * std::sqrt(L), k3 = 1.1 * L, h = kPeriod, step = 8;
  Pushed arm(L);
  double s = 0, sigma = 0, settled = -1;
  for (int k = 1; k <= 1000; ++k) {
    const double found = arm.Tick(PerJoint::Constant(7, step))(0);
    const double b = s + h * step - h * sigma;
    // f(x) = x + h k₁ √x + h² k₃ rises through |b| once, unless |b| lies in the jump at 0.
    double least = 0, most = std::abs(b);
    for (int i = 0; i < 200; ++i) {
      const double x = 0.5 * (least + most);
      (x + h * k1 * std::sqrt(x) + h * h * k3 < std::abs(b) ? least : most) = x;
    }
    const bool slides = std::abs(b) <= h * h * k3;
    s = slides ? 0 : std::copysign(most, b);
    sigma += slides ? b / h : std::copysign(h * k3, b);
    ASSERT_NEAR(found, sigma, 1e-9) << k;  // bisection: 2^-53 of b, over h, summed
    if (std::abs(found - step) > 1e-9) settled = -1;
    if (settled < 0 && std::abs(found - step) <= 1e-9) settled = k * h;
  }
  EXPECT_GE(settled, step / k3);      // it cannot rise faster
  EXPECT_LE(settled, 3 * step / k3);  // and overshoots at most once for these gains
}

// With a momentum that jitters by ± n, σ moves by no more than h k₃ from sample to sample.
TEST(SuperTwistingObserver, LetsNoiseThroughAtItsRateOnly) {
  Pushed arm(100);
  RandomStates random(Gen3(), 3);
  PerJoint last = PerJoint::Zero(7);
  double most = 0;
  for (int k = 0; k < 5000; ++k) {
    const PerJoint now = arm.Tick(random.Uniform(50));
    most = std::max(most, (now - last).cwiseAbs().maxCoeff());
    last = now;
  }
  EXPECT_LE(most, kPeriod * 1.1 * 100 * (1 + 1e-12));
  EXPECT_GT(most, 0);
}

TEST(SuperTwistingObserver, TakesRotorsOffTheMomentum) {
  const RobotModel m = Gen3();
  RandomStates random(m, 54);
  const PerJoint B = random.Uniform(1).cwiseAbs();
  BlockTester<ModelDynamics> links({.model = m}), all({.model = m, .rotor_inertia = B});
  // fast enough to slide from one random torque to the next: σ_k = τ̄_k
  SuperTwistingObserver::Options o{
      .joints = m.joints(), .rate = PerJoint::Constant(7, 1e8), .period = 1ms};
  BlockTester<SuperTwistingObserver> of_links(o);
  o.rotor_inertia = B;
  BlockTester<SuperTwistingObserver> of_all(o);
  const auto tick = [](auto& observer, const RobotDynamics& d, const JointTorque& tau) {
    observer.Set(observer->dynamics, d);
    observer.Set(observer->torque, tau);
    observer.Tick();
    return observer.Get(observer->residual);
  };
  for (int k = 0; k < 100; ++k) {
    const JointPosition q = random.q();
    const JointVelocity v = random.v();
    const JointTorque tau = random.tau();
    for (auto* model : {&links, &all}) {
      model->Set((*model)->position, q);
      model->Set((*model)->velocity, v);
    }
    const PerJoint expected = tick(of_links, links.Get(links->dynamics), tau);
    const PerJoint found = tick(of_all, all.Get(all->dynamics), tau);
    ASSERT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-10) << k;  // ε 10 N·m·s / h, and sums
  }
}

TEST(SuperTwistingObserver, RefusesRatesThatAreNone) {
  const Joints joints = Joints::Numbered(2);
  const auto error = [&](const PerJoint& rate) {
    return ErrorOf(
        [&] { SuperTwistingObserver o({.joints = joints, .rate = rate, .period = 1ms}); });
  };
  EXPECT_EQ(error(PerJoint::Ones(3)), "rate has an element for each of the 2 joints, got 3");
  EXPECT_EQ(error(PerJoint::Zero(2)), "rate[joint_1] must be > 0 N·m/s, got 0");
  EXPECT_EQ(error(PerJoint::Constant(2, std::numeric_limits<double>::infinity())),
            "rate[joint_1] must be > 0 N·m/s, got inf");
  EXPECT_EQ(ErrorOf([&] {
              SuperTwistingObserver o({.joints = joints,
                                       .rate = PerJoint::Ones(2),
                                       .period = 1ms,
                                       .rotor_inertia = PerJoint::Constant(2, -1)});
            }),
            "rotor_inertia[joint_1] must be >= 0 kg·m², got -1");
}

}  // namespace
}  // namespace pliant
