#include "pliant/controllers/passivity_monitor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pliant/controllers/motion_generator.h"
#include "pliant/controllers/null_space_impedance.h"
#include "pliant/controllers/velocity_tracking.h"
#include "pliant/systems/block_tester.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

const Vector3d kDamping(40, 40, 10);
constexpr double kGain = 2, kPeriod = 1e-3;
const PerJoint kRotors =
    JointTorque{0.9, 0.9, 0.5, 0.5, 0.2, 0.13, 0.13};  // kg·m², about the LWR's
const JointPosition kStart{0, 2 * std::numbers::pi / 9,  0, -std::numbers::pi / 2,
                           0, 5 * std::numbers::pi / 18, 0};

/// What may be other than the proof has it.
struct Breach {
  double rate_gain_s = 0;     ///< k_d, with the exact ë_p
  bool delayed_rate = false;  ///< or with that of the sample before
  double speed = 0;           ///< of ṗ̃_d, which goes round [m/s]
  double turn = 0;            ///< and how fast [rad/s]
  double friction = 0;        ///< of each joint, viscous [N·m·s/rad]
  bool of_proof = false;      ///< and τ_f = −N d_n α_f q̇, that of the proof
  NullSpaceLaw law = NullSpaceLaw::Printed;
  double assumed = 0;  ///< c of `meant` [N·m]
};

/// The LWR with its rotors under null-space compliance, in continuous time: M q̈ + C q̇ = τᶜ + τⁿ +
/// τ_f + τ_e, gravity carried, by Runge–Kutta of order four; the account is kept every millisecond.
struct Arm {
  explicit Arm(const Breach& b)
      : breach{b},
        impedance{VelocityImpedance::Options{.joints = model.joints(), .damping = kDamping}},
        project{NullSpaceProjector::Options{.joints = model.joints()}},
        damp{NullSpaceImpedance::Options{
            .joints = model.joints(), .law = b.law, .coulomb = PerJoint::Constant(7, b.assumed)}},
        d(model, {"end_effector_link"}) {
    ComputeDynamics(model, kStart, JointVelocity::Zero(model.joints()), d);
    impedance.Set(impedance->target, d.frame[0].pose);
  }

  Vector3d Desired(double t) const {
    return breach.speed * Vector3d(std::cos(breach.turn * t), std::sin(breach.turn * t), 0);
  }
  Vector3d DesiredRate(double t) const {
    return breach.speed * breach.turn *
           Vector3d(-std::sin(breach.turn * t), std::cos(breach.turn * t), 0);
  }

  /// q̈ at (t, q, q̇).
  PerJoint Accelerate(double t, const PerJoint& q, const PerJoint& v, const PerJoint& tau_e) {
    ComputeDynamics(model, q, v, d);
    d.M.diagonal() += kRotors;
    const FrameDynamics& tool = d.frame[0];
    impedance.Set(impedance->frame, tool);
    project.Set(project->frame, tool);
    damp.Set(damp->null_space, project.Get(project->null_space));
    damp.Set(damp->desired, LinearVelocity(Desired(t)));
    damp.Set(damp->velocity, JointVelocity(v));
    const Vector3d e = Desired(t) - tool.twist.tail<3>();
    // D k_d ë_p with ë_p = p̈_d − J̇ q̇ − J q̈: its last part is an inertia.
    const double k_d = breach.rate_gain_s;
    const Eigen::Matrix<double, 3, 7> J = tool.J.bottomRows<3>();
    Vector3d rate = DesiredRate(t) - tool.Jdot_v.tail<3>();
    Eigen::Matrix<double, 7, 7> inertia = d.M;
    if (breach.delayed_rate)
      rate = last_rate;
    else
      inertia += J.transpose() * (k_d * kDamping).asDiagonal() * J;
    impedance.Set(impedance->command, LinearVelocity(kGain * e + k_d * rate));
    const PerJoint tau = impedance.Get(impedance->torque) + PerJoint(damp.Get(damp->torque)) -
                         breach.friction * v - FrictionOfProof(v) + tau_e - PerJoint(d.coriolis);
    const PerJoint a = inertia.llt().solve(Eigen::Matrix<double, 7, 1>(tau));
    now_rate = DesiredRate(t) - tool.Jdot_v.tail<3>() - J * Eigen::Matrix<double, 7, 1>(a);
    return a;
  }

  /// N d_n α_f q̇ with the law's d_n and α_f.
  PerJoint FrictionOfProof(const PerJoint& v) {
    if (!breach.of_proof) return PerJoint::Zero(7);
    const NullSpaceImpedance::Options law;
    return project.Get(project->null_space)
        .projector.lazyProduct(law.damping * law.friction_gain * v);
  }

  void Account(double t, const PerJoint& q, const PerJoint& v, const PerJoint& tau_e) {
    Accelerate(t, q, v, tau_e);
    monitor->Set((*monitor)->dynamics, d);
    monitor->Set((*monitor)->desired_velocity, damp.Get(damp->desired_velocity));
    monitor->Set((*monitor)->orientation_error, impedance.Get(impedance->orientation_error));
    monitor->Set((*monitor)->velocity_error,
                 LinearVelocity(Desired(t) - Vector3d(d.frame[0].twist.tail<3>())));
    monitor->Set((*monitor)->external_torque, JointTorque(tau_e));
    monitor->Tick();
    last_rate = now_rate;
  }

  /// The largest excess while τ_e = push sin²(π t/T) for T, from a state on [J].
  double Run(PerJoint q, PerJoint v, const PerJoint& push, double T, int steps) {
    const double h = kPeriod;
    const auto tau_e = [&](double t) {
      if (t >= T) return PerJoint(PerJoint::Zero(7));
      return PerJoint(std::pow(std::sin(std::numbers::pi * t / T), 2) * push);
    };
    last_rate.setZero();
    monitor.emplace(PassivityMonitor::Options{.joints = model.joints(),
                                              .damping = kDamping,
                                              .stiffness = Vector3d::Constant(15),
                                              .rate_gain_s = breach.rate_gain_s,
                                              .period = 1ms});
    double largest = -1e9;
    for (int i = 0; i <= steps; ++i) {
      const double t = i * h;
      Account(t, q, v, tau_e(t));
      largest = std::max(largest, monitor->Get((*monitor)->excess));
      const PerJoint a1 = Accelerate(t, q, v, tau_e(t)), v2 = v + 0.5 * h * a1;
      const PerJoint a2 = Accelerate(t + h / 2, q + 0.5 * h * v, v2, tau_e(t + h / 2));
      const PerJoint v3 = v + 0.5 * h * a2;
      const PerJoint a3 = Accelerate(t + h / 2, q + 0.5 * h * v2, v3, tau_e(t + h / 2));
      const PerJoint v4 = v + h * a3;
      const PerJoint a4 = Accelerate(t + h, q + h * v3, v4, tau_e(t + h));
      q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return largest;
  }

  const RobotModel model = Lwr();
  const Breach breach;
  BlockTester<VelocityImpedance> impedance;
  BlockTester<NullSpaceProjector> project;
  BlockTester<NullSpaceImpedance> damp;
  std::optional<BlockTester<PassivityMonitor>> monitor;  // of the last run
  RobotDynamics d;
  Vector3d last_rate = Vector3d::Zero(), now_rate = Vector3d::Zero();
};

PerJoint Still() { return PerJoint::Zero(7); }

TEST(PassivityMonitor, AccountsForStorageAndSupply) {
  const RobotModel m = Lwr();
  RandomStates random(m, 71);
  BlockTester<PassivityMonitor> t(PassivityMonitor::Options{.joints = m.joints(),
                                                            .damping = kDamping,
                                                            .stiffness = Vector3d(15, 10, 5),
                                                            .rate_gain_s = 0.1,
                                                            .period = 1ms});
  double first = 0, supply = 0, last_power = 0;
  for (int k = 0; k < 20; ++k) {
    RobotDynamics d(m);
    ComputeDynamics(m, random.q(), random.v(), d);
    const JointVelocity qd = random.v();
    const JointTorque tau_e = random.tau();
    const Vector3d e_r = random.Uniform(1).head<3>(), e_p = random.Uniform(1).head<3>();
    t.Set(t->dynamics, d);
    t.Set(t->desired_velocity, qd);
    t.Set(t->orientation_error, e_r);
    t.Set(t->velocity_error, e_p);
    t.Set(t->external_torque, tau_e);
    t.Tick();
    const PerJoint e = qd - PerJoint(d.v);
    const double S = 0.5 * e.dot(d.M * e) + 0.5 * e_r.dot(Vector3d(15, 10, 5).cwiseProduct(e_r)) +
                     0.05 * e_p.dot(kDamping.cwiseProduct(e_p));
    const double power = -e.dot(PerJoint(tau_e));
    if (k == 0) first = S;
    if (k > 0) supply += 0.5e-3 * (power + last_power);
    last_power = power;
    EXPECT_NEAR(t.Get(t->storage), S, 1e-12);
    EXPECT_NEAR(t.Get(t->supply), supply, 1e-12);
    EXPECT_NEAR(t.Get(t->excess), S - first - supply, 1e-12);
  }
}

// What the proof assumes: q̇_d constant, here 0, no friction or that of the proof, J of full rank,
// ë_p as it is. The excess is −∫ dissipation but for the trapezoidal rule, wrong by at most
// h²/12 ∫|p̈| of the supply p = q̇ᵀ τ_e, which is zero once the push is over. With ‖τ_e‖ ≤ 20 N·m
// over T ≥ 0.1 s and rotors of at least 0.13 kg·m²: ‖q̇‖ ≤ 3 rad/s, ‖q̈‖ ≤ 150 rad/s²,
// ‖τ̇_e‖ ≤ 630 N·m/s, ‖τ̈_e‖ ≤ 4e4 N·m/s², so p̈ ≤ ‖q̇‖‖τ̈_e‖ + 2‖q̈‖‖τ̇_e‖ + … of about 4e5 W/s²
// while T = 0.1 s, and less, as 1/T², for longer ones: T p̈ is most at T = 0.1 s, 3.3 mJ.
TEST(PassivityMonitor, FindsNoExcessUnderTheAssumptionsOfTheProofWhileAThousandPushesLastAndAfter) {
  for (const double k_d : {0.0, 0.1})
    for (const bool of_proof : {false, true}) {
      Arm arm({.rate_gain_s = k_d, .of_proof = of_proof});
      RandomStates random(arm.model, 72);
      double largest = -1e9;
      for (int i = 0; i < 250; ++i) {
        const PerJoint q = kStart + random.Uniform(0.4);
        const PerJoint v = random.Uniform(0.5);
        const double T = 0.1 + 0.2 * std::abs(random.Uniform(1)(0));
        PerJoint push = random.Uniform(20);
        push /= std::max(1.0, push.norm() / 20);
        push.tail(3) *= 0.05;  // the wrist is light
        const int steps = static_cast<int>(std::lround(2 * T / kPeriod));
        largest = std::max(largest, arm.Run(q, v, push, T, steps));
      }
      EXPECT_LT(largest, 3.3e-3) << k_d << (of_proof ? ", with friction" : "");
    }
}

TEST(PassivityMonitor, FindsTheEnergyThatIsLost) {
  // Pushed and then left alone, all that was given is lost in the end, or in the springs of K_ω.
  Arm arm({});
  PerJoint push = Still();
  push(2) = 15;
  arm.Run(kStart, Still(), push, 0.3, 300);
  const double supplied = arm.monitor->Get((*arm.monitor)->supply);
  EXPECT_GT(supplied, 0.05);
  EXPECT_LT(arm.monitor->Get((*arm.monitor)->excess), -0.02 * supplied);
}

/// q̇_d at the start for ṗ̃_d along x [rad/s].
PerJoint Wanted(Arm& arm, double speed) {
  ComputeDynamics(arm.model, kStart, JointVelocity::Zero(arm.model.joints()), arm.d);
  arm.project.Set(arm.project->frame, arm.d.frame[0]);
  const NullSpace& of = arm.project.Get(arm.project->null_space);
  return of.inverse.rightCols<3>() * Vector3d(speed, 0, 0);
}

/// Joules out of nothing: from q̇ = q̇_d on, and without a push.
double Excess(const Breach& breach, int steps = 400) {
  Arm arm(breach);
  return arm.Run(kStart, Wanted(arm, breach.speed), Still(), 1, steps);
}

/// The same of a small motion in the null space.
double ExcessDrifting(const Breach& breach) {
  Arm arm(breach);
  Wanted(arm, 0);
  const PerJoint v = arm.project.Get(arm.project->null_space).projector.col(2) * 0.1;
  return arm.Run(kStart, v, Still(), 1, 300);
}

TEST(PassivityMonitor, FindsAWishThatChanges) {
  EXPECT_LT(Excess({}), 1e-9);                           // at rest
  EXPECT_GT(Excess({.speed = 0.1, .turn = 8}), 1e-3);    // ė_qᵀ M q̈_d
  EXPECT_LT(Excess({.speed = 0.1, .turn = 0.5}), 1e-3);  // as slow as the experiments have it
}

// NS-A, a round of 12.6 s: each direction of the tool is driven by at most F = Λ p̈_d and damped by
// D k_p, which leaves F²/(4 D k_p) at most. With some 10 kg and 0.05 m/s · 0.5 rad/s F = 0.25 N, of
// 80 N·s/m 0.2 mW: 2.5 mJ a round. What turns the tool is not damped here, and as much again.
TEST(PassivityMonitor, FindsLittleInTheSlowCircleOfTheExperiments) {
  EXPECT_LT(Excess({.speed = 0.05, .turn = 0.5}, 12566), 5e-3);
}

TEST(PassivityMonitor, FindsCompensationOfFrictionThatIsNotThere) {
  // Without a push nothing is supplied, and S is integrated to fourth order.
  EXPECT_LT(ExcessDrifting({}), 1e-9);
  EXPECT_GT(ExcessDrifting({.law = NullSpaceLaw::Meant, .assumed = 0.5}), 1e-3);
  EXPECT_LT(ExcessDrifting({.friction = 5, .law = NullSpaceLaw::Meant, .assumed = 0.5}), 1e-9);
}

// Friction takes −ė_qᵀ τ_f = d ė_qᵀ q̇, and gives it back to S where q̇ goes along q̇_d but slower.
TEST(PassivityMonitor, FindsFrictionThatPullsAlongTheError) {
  EXPECT_GT(Excess({.speed = 0.1, .friction = 5}), Excess({.speed = 0.1}) + 1e-3);
}

// k_d is an inertia of D k_d that is late: with ë_p of the sample before it may drive the arm, here
// where D k_d is more than the arm's own inertia at the tool.
TEST(PassivityMonitor, FindsARateThatIsLate) {
  const auto excess = [](bool late) {
    Arm arm({.rate_gain_s = 0.5, .delayed_rate = late});
    PerJoint v = Still();
    v(0) = 0.1;
    return arm.Run(kStart, v, Still(), 1, 20);
  };
  EXPECT_LT(excess(false), 1e-6);
  EXPECT_GT(excess(true), 1e-3);
}

TEST(PassivityMonitor, BeginsItsAccountWhenItIsToldTo) {
  const RobotModel m = Lwr();
  RandomStates random(m, 73);
  BlockTester<PassivityMonitor> t(PassivityMonitor::Options{.joints = m.joints(),
                                                            .damping = kDamping,
                                                            .stiffness = {15, 15, 15},
                                                            .from_s = 5e-3,
                                                            .period = 1ms});
  RobotDynamics d(m);
  for (int k = 0; k < 8; ++k) {
    ComputeDynamics(m, random.q(), random.v(), d);
    t.Set(t->dynamics, d);
    t.Set(t->desired_velocity, random.v());
    t.Set(t->orientation_error, Vector3d(0.1, 0, 0));
    t.Set(t->velocity_error, Vector3d(0, 0.1, 0));
    t.Set(t->external_torque, random.tau());
    t.Tick();
    const double now = t.simulator().time();
    EXPECT_EQ(t.Get(t->storage) == 0, now < 5e-3) << now;
    EXPECT_EQ(t.Get(t->supply) == 0, now < 6e-3) << now;
  }
}

TEST(PassivityMonitor, PassesTheLawsOfBlocks) {
  BlockTester<PassivityMonitor> t(PassivityMonitor::Options{.joints = Lwr().joints(),
                                                            .damping = kDamping,
                                                            .stiffness = {15, 15, 15},
                                                            .rate_gain_s = 0.1,
                                                            .period = 1ms});
  t.Set(t->dynamics, RobotDynamics(Lwr()));
  ExpectBlockLaws(std::move(t));
}

TEST(PassivityMonitor, RefusesOptionsOutOfRange) {
  using testing::HasSubstr;
  const auto error = [](auto change) {
    PassivityMonitor::Options o{
        .joints = Lwr().joints(), .damping = kDamping, .stiffness = {15, 15, 15}, .period = 1ms};
    change(o);
    return ErrorOf([&] { PassivityMonitor block(o); });
  };
  EXPECT_THAT(error([](auto& o) { o.damping(0) = -1; }), HasSubstr("damping"));
  EXPECT_THAT(error([](auto& o) { o.stiffness(0) = -1; }), HasSubstr("stiffness"));
  EXPECT_THAT(error([](auto& o) { o.rate_gain_s = -1; }), HasSubstr("rate_gain_s must be"));
  EXPECT_THAT(error([](auto& o) { o.from_s = -1; }), HasSubstr("from_s must be"));
}

}  // namespace
}  // namespace pliant
