#include "pliant/analysis/compliance_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/shared_file.h"

namespace pliant {
namespace {

// s/((s + K)(s + 20)²) · 1/s has the inverse (e^{−Kt} − e^{−20t})/α² + t e^{−20t}/α, α = K − 20.
TEST(DeviationBehindObserver, IsTheStepResponseInClosedForm) {
  constexpr double K = 50, alpha = K - 20;
  const Series a = Series::Ones(1, 500);
  const Series e = DeviationBehindObserver(a, K, 40, 400, 1ms);
  for (int k = 0; k < 500; ++k) {
    const double t = 1e-3 * k;
    const double expected =
        (std::exp(-K * t) - std::exp(-20 * t)) / (alpha * alpha) + t * std::exp(-20 * t) / alpha;
    // the exact discretisation leaves round-off, which 500 products let grow to 500 ε of the peak
    EXPECT_NEAR(e(0, k), expected, 500 * 2.3e-16 * 5e-3) << "t = " << t;
  }
}

TEST(DeviationBehindObserver, IsLinearAndTreatsRowsAlike) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const Series a = Series::NullaryExpr(2, 100, [&] { return normal(random); });
  Series both(1, 100);
  both.row(0) = 2 * a.row(0) - 3 * a.row(1);
  const Series e = DeviationBehindObserver(a, 30, 10, 100, 1ms);
  const Series sum = DeviationBehindObserver(both, 30, 10, 100, 1ms);
  EXPECT_LT((sum.row(0) - (2 * e.row(0) - 3 * e.row(1))).cwiseAbs().maxCoeff(), 1e-17);
}

TEST(DeviationBehindObserver, RefusesAGainThatIsNotPositive) {
  try {
    DeviationBehindObserver(Series::Zero(1, 2), 0, 40, 400, 1ms);
    FAIL() << "no Error";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "observer_gain must be > 0, got 0");
  }
}

TEST(TaskAcceleration, IsTheAccelerationThatForwardDynamicsGivesTheFrame) {
  const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  const PerJoint B = PerJoint::Constant(7, 0.3);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  RobotDynamics d(model, {"tool_frame"});
  for (int i = 0; i < 100; ++i) {
    const Series q = Series::NullaryExpr(7, 1, [&] { return uniform(random); });
    const Series tau_e = Series::NullaryExpr(7, 1, [&] { return 10 * uniform(random); });
    const Series a = TaskAcceleration(model, "tool_frame", q, tau_e, B);

    ComputeDynamics(model, q.col(0), JointVelocity::Zero(model.joints()), d);
    // at rest, with gravity carried, only τ_e accelerates: V̇ = J v̇
    const JointAcceleration vdot = ForwardDynamics(d, d.gravity, tau_e.col(0), B);
    const Vector6 expected = d.frame[0].J * vdot;
    EXPECT_LT((a.col(0) - expected).norm(),
              1e-11 * (1 + expected.norm()));  // two solves, cond M ~ 10
  }
}

TEST(TaskAcceleration, RefusesSeriesOfOtherSizes) {
  const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  try {
    TaskAcceleration(model, "tool_frame", Series::Zero(6, 3), Series::Zero(7, 3), {});
    FAIL() << "no Error";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "q and tau_e have a row per joint and a column per sample");
  }
}

}  // namespace
}  // namespace pliant
