#include "pliant/plants/joint_sensors.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "pliant/systems/block_tester.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/statistics.h"

namespace pliant {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPeriod = 1e-3;
constexpr int kSamples = 100'000;
const Joints kTwo{"shoulder", "elbow"};

double Alpha(double cutoff_hz) { return 1 - std::exp(-2 * std::numbers::pi * cutoff_hz * kPeriod); }

/// What the sensors show at n ticks, a row each: position, velocity, torque, current.
struct Readings {
  MatrixXd q, v, tau, i;
};

/// `move` sets the inputs before tick k.
Readings Read(const JointSensors::Options& o, int n,
              const std::function<void(BlockTester<JointSensors>&, int k)>& move = {}) {
  const int joints = o.joints.size();
  BlockTester<JointSensors> t(o);
  t.Set(t->position, JointPosition::Zero(o.joints));
  t.Set(t->velocity, JointVelocity::Zero(o.joints));
  t.Set(t->torque, JointTorque::Zero(o.joints));
  Readings r{MatrixXd(n, joints), MatrixXd(n, joints), MatrixXd(n, joints), MatrixXd(n, joints)};
  for (int k = 0; k < n; ++k) {
    if (move) move(t, k);
    t.Tick();
    r.q.row(k) = t.Get(t->measured_position).transpose();
    r.v.row(k) = t.Get(t->measured_velocity).transpose();
    r.tau.row(k) = t.Get(t->measured_torque).transpose();
    r.i.row(k) = t.Get(t->measured_current).transpose();
  }
  return r;
}

TEST(JointSensors, AreIdealUnlessToldOtherwise) {
  BlockTester<JointSensors> t({.joints = kTwo, .period = 1ms});
  t.Set(t->position, {0.1, -0.2});
  t.Set(t->velocity, {0.3, 0.4});
  t.Set(t->torque, {-5, 6});
  t.Tick();
  EXPECT_EQ(t.Get(t->measured_position), (JointPosition{0.1, -0.2}));
  EXPECT_EQ(t.Get(t->measured_velocity), (JointVelocity{0.3, 0.4}));
  EXPECT_EQ(t.Get(t->measured_torque), (JointTorque{-5, 6}));
  EXPECT_EQ(t.Get(t->measured_current), (MotorCurrent{0, 0})) << "not connected";
  t.Set(t->current, {0.7, -0.8});
  t.Tick();
  EXPECT_EQ(t.Get(t->measured_current), (MotorCurrent{0.7, -0.8}));
}

TEST(JointSensors, RoundPositionsToTheNearestQuantum) {
  const PerJoint quantum{{1e-3, 0.0}};
  BlockTester<JointSensors> t({.joints = kTwo, .period = 1ms, .position_quantum = quantum});
  t.Set(t->velocity, {0, 0});
  t.Set(t->torque, {0, 0});
  VectorXd error(10'000);
  for (int k = 0; k < error.size(); ++k) {
    const double q = -1 + k * std::numbers::sqrt2 * 1e-3;
    t.Set(t->position, {q, q});
    t.Tick();
    const JointPosition& measured = t.Get(t->measured_position);
    const double quanta = measured(0) / 1e-3;
    EXPECT_NEAR(quanta, std::round(quanta), 1e-11);  // round-off of some 10⁴ quanta
    error(k) = measured(0) - q;
    EXPECT_EQ(measured(1), q);
  }
  EXPECT_LE(error.cwiseAbs().maxCoeff(), 0.5e-3 * (1 + 1e-11));
  // Multiples of √2 are spread evenly over the quantum, to some 1/n.
  EXPECT_NEAR(Variance(error) / (1e-6 / 12), 1, 1e-3);
}

TEST(JointSensors, HaveWhiteNoiseOfTheGivenDeviations) {
  const PerJoint sigma_q{{1e-5, 3e-5}}, sigma_v{{0.01, 0.02}}, sigma_tau{{0.15, 0.08}},
      sigma_i{{0.03, 0.01}};
  const Readings r = Read({.joints = kTwo,
                           .period = 1ms,
                           .position_noise = sigma_q,
                           .velocity_noise = sigma_v,
                           .torque_noise = sigma_tau,
                           .current_noise = sigma_i,
                           .seed = 11},
                          kSamples);
  MatrixXd all(kSamples, 8);
  all << r.q, r.v, r.tau, r.i;
  VectorXd sigma(8);
  sigma << sigma_q, sigma_v, sigma_tau, sigma_i;
  for (int i = 0; i < 8; ++i) {
    const VectorXd x = all.col(i) / sigma(i);
    EXPECT_LT(std::abs(x.mean()), MeanBound(kSamples)) << i;
    EXPECT_LT(std::abs(Variance(x) - 1), VarianceBound(kSamples)) << i;
    for (int j = 0; j < 8; ++j)
      for (int lag = 0; lag < 3; ++lag) {
        if (i == j && lag == 0) continue;
        EXPECT_LT(std::abs(Correlation(x, all.col(j), lag)), MeanBound(kSamples - lag))
            << i << " and " << j << " at lag " << lag;
      }
  }
}

TEST(JointSensors, MakeOfNoisyPositionsAVelocityOfTheStatedDeviation) {
  const PerJoint cutoff{{30.0, 95.0}};
  const Readings r = Read({.joints = kTwo,
                           .period = 1ms,
                           .position_noise = PerJoint::Constant(2, 1e-5),
                           .velocity_cutoff_hz = cutoff,
                           .seed = 12},
                          kSamples);
  const int settled = kSamples - 100;  // (1 − α)¹⁰⁰ < 1e-8
  for (int i = 0; i < 2; ++i) {
    const double alpha = Alpha(cutoff(i));
    const double sigma = 1e-5 / kPeriod * alpha * std::sqrt(2 / (2 - alpha));
    // ρ(l) = −(1 − α)^{l−1} α/2, of the weights in the header. The sum Σ ρ² over all lags widens
    // the variance of s² to 2 σ⁴/n · Σ ρ².
    double squares = 1;
    for (int lag = 1; lag < 200; ++lag)
      squares += 2 * std::pow(std::pow(1 - alpha, lag - 1) * alpha / 2, 2);
    const VectorXd x = r.v.col(i).tail(settled) / sigma;
    EXPECT_LT(std::abs(Variance(x) - 1), VarianceBound(settled) * std::sqrt(squares)) << i;
    for (int lag = 1; lag < 4; ++lag)
      EXPECT_NEAR(Correlation(x, x, lag), -std::pow(1 - alpha, lag - 1) * alpha / 2,
                  2 * MeanBound(settled));
  }
}

TEST(JointSensors, FilterVelocityWithTheStatedGainAndPhase) {
  const PerJoint cutoff{{20.0, 95.0}};
  for (const double frequency_hz : {1.0, 20.0, 150.0, 400.0}) {
    const double omega = 2 * std::numbers::pi * frequency_hz;
    const int n = 1000;  // (1 − α)^500 < 1e-27, and then a whole number of waves
    const Readings r = Read({.joints = kTwo, .period = 1ms, .velocity_cutoff_hz = cutoff}, n,
                            [&](BlockTester<JointSensors>& t, int k) {
                              const double q = std::sin(omega * k * kPeriod);
                              t.Set(t->position, {q, q});
                            });
    for (int i = 0; i < 2; ++i) {
      const double alpha = Alpha(cutoff(i));
      const std::complex<double> z = std::polar(1.0, omega * kPeriod);
      const std::complex<double> H = alpha * (1.0 - 1.0 / z) / (kPeriod * (1.0 - (1 - alpha) / z));
      for (int k = 500; k < n; ++k)
        EXPECT_NEAR(r.v(k, i), std::imag(H * std::polar(1.0, omega * k * kPeriod)),
                    1e-10 * std::abs(H))  // round-off of positions over h
            << frequency_hz << " Hz, tick " << k;
    }
  }
}

TEST(JointSensors, LagBehindARampOfVelocityByTheStatedDelay) {
  const double a = 3, alpha = Alpha(95), delay = kPeriod * (0.5 + (1 - alpha) / alpha);
  const Readings r =
      Read({.joints = kTwo, .period = 1ms, .velocity_cutoff_hz = PerJoint::Constant(2, 95)}, 500,
           [&](BlockTester<JointSensors>& t, int k) {
             const double time = k * kPeriod;
             t.Set(t->position, PerJoint::Constant(2, 0.5 * a * time * time));
             t.Set(t->velocity, PerJoint::Constant(2, a * time));
           });
  for (int k = 100; k < 500; ++k) EXPECT_NEAR(r.v(k, 0), a * (k * kPeriod - delay), 1e-12);
}

TEST(JointSensors, BeginWithTheVelocityThatIsThere) {
  const Readings r =
      Read({.joints = kTwo, .period = 1ms, .velocity_cutoff_hz = PerJoint::Constant(2, 10)}, 100,
           [&](BlockTester<JointSensors>& t, int k) {
             t.Set(t->position, PerJoint::Constant(2, 1 + 2 * k * kPeriod));
             t.Set(t->velocity, {2, 2});
           });
  EXPECT_LT((r.v.array() - 2).abs().maxCoeff(), 1e-12);  // round-off of positions over h
}

TEST(JointSensors, OffsetTorquesByTheirBias) {
  const PerJoint bias{{0.4, -0.3}};
  const Readings r = Read({.joints = kTwo, .period = 1ms, .torque_bias = bias}, 3,
                          [](BlockTester<JointSensors>& t, int) {
                            t.Set(t->torque, {1, 2});
                          });
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(r.tau.row(k).transpose(), bias + PerJoint::LinSpaced(2, 1, 2));
}

TEST(JointSensors, DriftAsAnOrnsteinUhlenbeckProcess) {
  const double time_s = 0.02, a = std::exp(-kPeriod / time_s);
  const PerJoint sigma{{0.05, 0.2}};
  const Readings r = Read({.joints = kTwo,
                           .period = 1ms,
                           .torque_drift = sigma,
                           .torque_drift_time_s = time_s,
                           .seed = 13},
                          kSamples);
  // n samples tell as much about the variance as n (1 − a²)/(1 + a²) independent ones.
  const double independent = kSamples * (1 - a * a) / (1 + a * a);
  for (int i = 0; i < 2; ++i) {
    const VectorXd x = r.tau.col(i) / sigma(i);
    EXPECT_LT(std::abs(Variance(x) - 1), VarianceBound(static_cast<int>(independent)));
    for (const int lag : {1, 5, 20, 60})  // Bartlett's bound holds for every lag
      EXPECT_NEAR(Correlation(x, x, lag), std::exp(-lag * kPeriod / time_s),
                  MeanBound(static_cast<int>(independent)));
    // What is new at each tick is white.
    const VectorXd fresh = (x.tail(kSamples - 1) - a * x.head(kSamples - 1)) / std::sqrt(1 - a * a);
    EXPECT_LT(std::abs(Variance(fresh) - 1), VarianceBound(kSamples - 1));
    EXPECT_LT(std::abs(Correlation(fresh, fresh, 1)), MeanBound(kSamples - 2));
  }
  EXPECT_LT(std::abs(Correlation(r.tau.col(0), r.tau.col(1))),
            MeanBound(static_cast<int>(independent)));
}

TEST(JointSensors, BeginToDriftFromTheStationaryDistribution) {
  const int seeds = 2000;
  VectorXd first(seeds);
  for (int seed = 0; seed < seeds; ++seed)
    first(seed) = Read({.joints = {"elbow"},
                        .period = 1ms,
                        .torque_drift = PerJoint::Constant(1, 0.5),
                        .seed = static_cast<std::uint64_t>(seed)},
                       1)
                      .tau(0, 0) /
                  0.5;
  EXPECT_LT(std::abs(first.mean()), MeanBound(seeds));
  EXPECT_LT(std::abs(Variance(first) - 1), VarianceBound(seeds));
}

TEST(JointSensors, AreAFunctionOfTheirSeed) {
  const Joints joints = Joints::Numbered(7);
  const Readings first = Read(Gen3JointSensors(joints, 1ms, 5), 100);
  const Readings same = Read(Gen3JointSensors(joints, 1ms, 5), 100);
  const Readings other = Read(Gen3JointSensors(joints, 1ms, 6), 100);
  EXPECT_EQ(first.q, same.q);
  EXPECT_EQ(first.v, same.v);
  EXPECT_EQ(first.tau, same.tau);
  EXPECT_TRUE((first.tau.array() != other.tau.array()).all());
}

TEST(JointSensors, ShowTheSameNumbersWhenResumedFromASnapshot) {
  const Joints joints = Joints::Numbered(7);
  const JointSensors::Options o = Gen3JointSensors(joints, 1ms, 9);
  BlockTester<JointSensors> t(o);
  t.Set(t->position, JointPosition::Zero(joints));
  t.Set(t->velocity, JointVelocity::Zero(joints));
  t.Set(t->torque, JointTorque::Zero(joints));
  t.AdvanceTo(0.0505);
  const Context snapshot = t.simulator().Snapshot();
  MatrixXd numbers[2];
  for (MatrixXd& run : numbers) {
    t.simulator().Restore(snapshot);
    run.resize(50, 21);
    for (int k = 0; k < 50; ++k) {
      t.Tick();
      run.row(k) << t.Get(t->measured_position).transpose(),
          t.Get(t->measured_velocity).transpose(), t.Get(t->measured_torque).transpose();
    }
  }
  EXPECT_EQ(numbers[0], numbers[1]);
}

TEST(JointSensors, OfAGen3HaveTheirFigures) {
  const Joints joints = Joints::Numbered(7);
  const int n = 20'000;
  const JointSensors::Options o = Gen3JointSensors(joints, 1ms, 21);
  EXPECT_LE(o.torque_bias.cwiseAbs().maxCoeff(), 0.5);
  EXPECT_GT(o.torque_bias.cwiseAbs().minCoeff(), 0);
  const Readings r = Read(o, n);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(std::sqrt(Variance(r.q.col(i))), 1e-5, 1e-5 * VarianceBound(n));
    EXPECT_NEAR(std::sqrt(Variance(r.v.col(i))), 0.005, 0.0002);
    // Over 20 s, a thirtieth of T, the drift moves by √(2/30) of its 0.05 N·m: much less than τ's
    // noise.
    EXPECT_NEAR(std::sqrt(Variance(r.tau.col(i))), i < 4 ? 0.15 : 0.08, 0.005);
    EXPECT_NEAR(r.tau.col(i).mean(), o.torque_bias(i), kDeviations * 0.05);
  }
  EXPECT_EQ(ErrorOf([] { Gen3JointSensors(kTwo, 1ms, 1); }), "a Gen3 has 7 joints, got 2");
}

TEST(JointSensors, RefuseFiguresOutOfTheirRange) {
  using O = JointSensors::Options;
  const auto error = [](auto change) {
    O o{.joints = kTwo, .period = 1ms};
    change(o);
    return ErrorOf([&] { BlockTester<JointSensors> t(o); });
  };
  const PerJoint bad{{1.0, -2.0}};
  EXPECT_EQ(error([&](O& o) { o.position_quantum = bad; }),
            "block: position_quantum[elbow] must be >= 0 rad, got -2");
  EXPECT_EQ(error([&](O& o) { o.position_noise = bad; }),
            "block: position_noise[elbow] must be >= 0 rad, got -2");
  EXPECT_EQ(error([&](O& o) { o.velocity_cutoff_hz = bad; }),
            "block: velocity_cutoff_hz[elbow] must be >= 0 Hz, got -2");
  EXPECT_EQ(error([&](O& o) { o.velocity_noise = bad; }),
            "block: velocity_noise[elbow] must be >= 0 rad/s, got -2");
  EXPECT_EQ(error([&](O& o) { o.torque_noise = bad; }),
            "block: torque_noise[elbow] must be >= 0 N·m, got -2");
  EXPECT_EQ(error([&](O& o) { o.torque_bias = PerJoint::Constant(2, NAN); }),
            "block: torque_bias[shoulder] must be finite N·m, got nan");
  EXPECT_EQ(error([&](O& o) { o.torque_drift = bad; }),
            "block: torque_drift[elbow] must be >= 0 N·m, got -2");
  EXPECT_EQ(error([&](O& o) { o.torque_drift_time_s = 0; }),
            "block: torque_drift_time_s must be > 0 s, got 0");
  EXPECT_EQ(error([&](O& o) { o.current_noise = bad; }),
            "block: current_noise[elbow] must be >= 0 A, got -2");
  EXPECT_EQ(error([&](O& o) { o.torque_noise = PerJoint::Ones(3); }),
            "block: torque_noise has an element for each of the 2 joints, got 3");
  EXPECT_EQ(error([&](O& o) {
              o.velocity_cutoff_hz = PerJoint{{0.0, 95.0}};
              o.velocity_noise = PerJoint{{0.1, 0.2}};
            }),
            "block: velocity_noise[elbow] must be 0 rad/s where velocity_cutoff_hz is > 0: "
            "position_noise makes it, got 0.2");
}

TEST(JointSensors, HoldTheLaws) {
  JointSensors::Options o = Gen3JointSensors(Joints::Numbered(7), 1ms, 4);
  o.current_noise = PerJoint::Constant(7, 0.01);
  ExpectBlockLaws(BlockTester<JointSensors>(o));
}

}  // namespace
}  // namespace pliant
