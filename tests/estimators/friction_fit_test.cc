#include "pliant/estimators/friction_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <random>

#include "pliant/plants/joint_sensors.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using testing::HasSubstr;

FrictionParameters Truth(bool stribeck) {
  return {.coulomb = 3, .viscous = 2.416, .stiction = stribeck ? 4.5 : 3, .stribeck_velocity = 0.1};
}

/// A staircase of velocities both ways, `each` samples a step.
VectorXd Staircase(int each, double slowest = 0.03, double fastest = 1.2, int steps = 12) {
  VectorXd v(2 * steps * each);
  for (int k = 0; k < v.size(); ++k) {
    const int step = k / each;
    const double x = static_cast<double>(step / 2) / (steps - 1);
    v(k) = (step % 2 ? -1 : 1) * slowest * std::pow(fastest / slowest, x);
  }
  return v;
}

FrictionSamples Noisy(const FrictionParameters& p, const VectorXd& velocity, double sigma,
                      unsigned seed, double bias = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FrictionSamples samples{.velocity = velocity, .torque = velocity};
  for (Index k = 0; k < velocity.size(); ++k)
    samples.torque(k) = SteadyFriction(p, velocity(k)) + bias + sigma * normal(random);
  return samples;
}

/// As the sensors of a Gen3 see it: v̂ of quantised, noisy positions through the filter of
/// JointSensors, τ with its noise and bias.
FrictionSamples AsMeasured(const FrictionParameters& p, const VectorXd& velocity, unsigned seed) {
  const Joints joint{"joint_1"};
  const JointSensors::Options gen3 =
      Gen3JointSensors(Joints::Numbered(7), std::chrono::milliseconds(1), seed);
  const double h = 1e-3,
               alpha = 1 - std::exp(-2 * 3.14159265358979 * gen3.velocity_cutoff_hz(0) * h);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  FrictionSamples samples{.velocity = velocity, .torque = velocity};
  double q = 0, last = 0, seen = velocity(0);
  for (Index k = 0; k < velocity.size(); ++k) {
    q += h * velocity(k);
    const double quantum = gen3.position_quantum(0);
    const double now =
        quantum * std::round((q + gen3.position_noise(0) * normal(random)) / quantum);
    // The filter has settled where a step begins: transients are taken out beforehand.
    if (k == 0 || velocity(k) != velocity(k - 1)) seen = velocity(k), last = now - h * seen;
    seen += alpha * ((now - last) / h - seen);
    last = now;
    samples.velocity(k) = seen;
    samples.torque(k) = SteadyFriction(p, velocity(k)) + gen3.torque_bias(0) +
                        gen3.torque_noise(0) * normal(random);
  }
  return samples;
}

TEST(FrictionFit, FindsTheParametersOfExactSamples) {
  for (const bool stribeck : {false, true})
    for (const bool separate : {false, true})
      for (const FrictionLoss loss :
           {FrictionLoss::None, FrictionLoss::Huber, FrictionLoss::Cauchy}) {
        const FrictionParameters p = Truth(stribeck);
        const FrictionFit fit = FitFriction(
            Noisy(p, Staircase(40, 0.02), 0, 1),
            {.model = stribeck ? FrictionModel::Stribeck : FrictionModel::CoulombViscous,
             .loss = loss,
             .separate = separate,
             .least_velocity = 0.01});
        for (const char* behind : {"_positive", "_negative"}) {
          const std::string end = separate ? behind : "";
          // Ceres ends when the cost, a square, changes by 1e-12 of itself or of what it was.
          EXPECT_NEAR(fit["coulomb" + end].value, 3, 1e-5);
          EXPECT_NEAR(fit["viscous" + end].value, 2.416, 1e-5);
          if (!stribeck) continue;
          EXPECT_NEAR(fit["stiction" + end].value, 4.5, 1e-5);
          EXPECT_NEAR(fit["stribeck_velocity" + end].value, 0.1, 1e-5);
        }
      }
}

TEST(FrictionFit, IsLeastSquaresWithoutALoss) {
  const FrictionSamples samples = Noisy(Truth(false), Staircase(100), 0.15, 2, 0.3);
  const FrictionFit fit =
      FitFriction(samples, {.loss = FrictionLoss::None, .offset = true, .least_velocity = 0.01});
  Eigen::MatrixX3d A(samples.velocity.size(), 3);
  A << samples.velocity.cwiseSign(), samples.velocity, VectorXd::Ones(samples.velocity.size());
  const Eigen::Vector3d x = A.colPivHouseholderQr().solve(samples.torque);
  EXPECT_NEAR(fit["coulomb"].value, x(0), 1e-8);
  EXPECT_NEAR(fit["viscous"].value, x(1), 1e-8);
  EXPECT_NEAR(fit["offset"].value, x(2), 1e-8);
  // White noise: its covariance is σ² (AᵀA)⁻¹, up to what 2400 squares of residuals scatter.
  const Eigen::Matrix3d covariance = 0.15 * 0.15 * (A.transpose() * A).inverse();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(fit.covariance(i, i) / covariance(i, i), 1, 0.3);
}

/// How often each interval holds the truth, of 200, and its mean half width.
struct Coverage {
  std::map<std::string, int> covered;
  std::map<std::string, double> half_width;
};
Coverage CoverageOf(const FrictionParameters& p, const FrictionFitOptions& options,
                    const VectorXd& velocity) {
  Coverage all;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const FrictionSamples samples = AsMeasured(p, velocity, 1000 + seed);
    const FrictionFit fit = FitFriction(samples, options);
    const auto count = [&](const std::string& name, double truth) {
      const FrictionEstimate* e = fit.Find(name);
      if (!e) return;
      all.covered[name] += e->low <= truth && truth <= e->high;
      all.half_width[name] += 0.5 * (e->high - e->low) / 200;
    };
    count("coulomb", p.coulomb);
    count("viscous", p.viscous);
    count("stiction", p.stiction);
    count("stribeck_velocity", p.stribeck_velocity);
    const double bias =
        Gen3JointSensors(Joints::Numbered(7), std::chrono::milliseconds(1), 1000 + seed)
            .torque_bias(0);
    count("offset", bias);
  }
  return all;
}

/// Half widths of 95 % intervals at the Cramér–Rao bound of white torque noise of 0.15 N·m.
VectorXd CramerRao(const FrictionParameters& p, const VectorXd& velocity, bool stribeck) {
  Eigen::MatrixXd J(velocity.size(), stribeck ? 5 : 3);
  for (Index k = 0; k < velocity.size(); ++k) {
    const double v = velocity(k), sign = v < 0 ? -1 : 1, x = v / p.stribeck_velocity;
    const double E = stribeck ? std::exp(-x * x) : 0;
    J(k, 0) = sign * (1 - E);
    J(k, 1) = v;
    J(k, 2) = 1;
    if (!stribeck) continue;
    J(k, 3) = sign * E;
    J(k, 4) = sign * (p.stiction - p.coulomb) * E * 2 * x * x / p.stribeck_velocity;
  }
  const Eigen::MatrixXd covariance = 0.15 * 0.15 * (J.transpose() * J).inverse();
  return 1.96 * covariance.diagonal().cwiseSqrt();
}

TEST(FrictionFit, IntervalsHoldTheTruthAsOftenAsTheySay) {
  for (const bool stribeck : {false, true}) {
    const FrictionParameters p = Truth(stribeck);
    const VectorXd velocity = Staircase(120, 0.04);
    const Coverage of =
        CoverageOf(p,
                   {.model = stribeck ? FrictionModel::Stribeck : FrictionModel::CoulombViscous,
                    .offset = true,
                    .folds = 0},
                   velocity);
    const VectorXd bound = CramerRao(p, velocity, stribeck);
    const std::vector<std::string> names{"coulomb", "viscous", "offset", "stiction",
                                         "stribeck_velocity"};
    for (int i = 0; i < bound.size(); ++i) {
      const std::string& name = names[static_cast<std::size_t>(i)];
      // A binomial of 200 at 0.95 is below 180 or above 199 once in 500 times.
      EXPECT_GE(of.covered.at(name), 180) << name;
      EXPECT_LE(of.covered.at(name), 199) << name;
      EXPECT_LT(of.half_width.at(name), 2 * bound(i)) << name;
      EXPECT_GT(of.half_width.at(name), 0.8 * bound(i)) << name;
    }
  }
}

TEST(FrictionFit, IntervalsHoldWhereNeighboursAreAlike) {
  // Noise through a low pass of 40 samples: white noise's intervals would be 9 times too narrow.
  const FrictionParameters p = Truth(false);
  int covered = 0;
  double inefficiency = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    FrictionSamples samples = Noisy(p, Staircase(800), 0, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const double a = std::exp(-1 / 40.0);
    double noise = normal(random);
    for (Index k = 0; k < samples.torque.size(); ++k) {
      samples.torque(k) += 0.15 * noise;
      noise = a * noise + std::sqrt(1 - a * a) * normal(random);
    }
    const FrictionFit fit = FitFriction(samples, {.least_velocity = 0.01, .folds = 0});
    covered += fit["coulomb"].low <= p.coulomb && p.coulomb <= fit["coulomb"].high;
    inefficiency += fit.inefficiency / 200;
  }
  // A binomial of 200 at 0.95 is below 180 or above 199 once in 500 times.
  EXPECT_GE(covered, 180);
  EXPECT_LE(covered, 199);
  EXPECT_NEAR(inefficiency, (1 + std::exp(-1 / 40.0)) / (1 - std::exp(-1 / 40.0)), 30);
}

TEST(FrictionFit, RobustLossesBearOutliersOfOneSide) {
  FrictionSamples samples = Noisy(Truth(true), Staircase(200), 0.15, 5);
  std::mt19937 random(6);
  for (Index k = 0; k < samples.torque.size(); ++k)
    if (random() % 20 == 0) samples.torque(k) += 5;
  const auto error = [&](FrictionLoss loss) {
    const FrictionFit fit = FitFriction(
        samples, {.model = FrictionModel::Stribeck, .loss = loss, .least_velocity = 0.01});
    // Its share of outliers is 5 %.
    if (loss == FrictionLoss::Cauchy) {
      EXPECT_NEAR(fit.outliers, 0.05, 0.01);
    }
    double worst = 0;
    for (const double v : {0.05, 0.3, 1.0, -0.05, -0.3, -1.0})
      worst = std::max(worst, std::abs(fit.Curve(v) - SteadyFriction(Truth(true), v)));
    return worst;
  };
  // Standard errors of 4800 samples are 0.01 N·m. Outliers shift Cauchy's estimate by
  // 0.05 ψ(33 σ)/E ψ' σ = 0.05 · 0.17 · 0.15/0.8 of either sign of motion, Huber's by 8 times that.
  EXPECT_LT(error(FrictionLoss::Cauchy), 0.04);
  EXPECT_LT(error(FrictionLoss::Huber), 0.1);
}

TEST(FrictionFit, NamesWhatOneSpeedDoesNotTell) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  VectorXd v = VectorXd::Constant(2000, 0.5);
  for (double& x : v) x += 0.005 * normal(random);
  const FrictionFit fit = FitFriction(Noisy(Truth(false), v, 0.1, 4), {.least_velocity = 0.01});
  ASSERT_EQ(fit.unidentified.size(), 2u);
  EXPECT_EQ(fit.unidentified[0].name, "coulomb");
  EXPECT_EQ(fit.unidentified[0].reason, "there is one speed only");
  EXPECT_EQ(fit.unidentified[1].name, "viscous");
  EXPECT_EQ(ErrorOf([&] { fit["coulomb"]; }),
            "'coulomb' was not identified: there is one speed only");
  EXPECT_TRUE(std::isnan(fit.Curve(0.5)));
}

TEST(FrictionFit, NamesStictionWhereNothingIsSlow) {
  const FrictionFit fit = FitFriction(Noisy(Truth(true), Staircase(100, 0.5), 0.15, 7),
                                      {.model = FrictionModel::Stribeck, .least_velocity = 0.01});
  ASSERT_EQ(fit.unidentified.size(), 2u);
  EXPECT_EQ(fit.unidentified[0].name, "stiction");
  EXPECT_EQ(fit.unidentified[1].name, "stribeck_velocity");
  EXPECT_NEAR(fit["coulomb"].value, 3, 5 * fit["coulomb"].deviation);
}

TEST(FrictionFit, NamesStictionThatIsNoMoreThanCoulomb) {
  const FrictionFit fit = FitFriction(Noisy(Truth(false), Staircase(100), 0.15, 8),
                                      {.model = FrictionModel::Stribeck, .least_velocity = 0.01});
  ASSERT_EQ(fit.unidentified.size(), 2u);
  EXPECT_THAT(fit.unidentified[0].reason,
              testing::AnyOf(HasSubstr("stiction cannot be told from coulomb"),
                             HasSubstr("slowly enough"), HasSubstr("do not tell")));
}

TEST(FrictionFit, NamesAnOffsetThatOneDirectionDoesNotTell) {
  const FrictionFit fit = FitFriction(Noisy(Truth(false), Staircase(100).cwiseAbs(), 0.15, 9, 0.3),
                                      {.offset = true, .least_velocity = 0.01});
  ASSERT_EQ(fit.unidentified.size(), 2u);
  EXPECT_EQ(fit.unidentified[0].name, "coulomb");
  EXPECT_EQ(fit.unidentified[1].name, "offset");
  EXPECT_EQ(fit.unidentified[1].reason,
            "with one direction only, an offset is not told from coulomb");
  EXPECT_NEAR(fit["viscous"].value, 2.416, 5 * fit["viscous"].deviation);
}

/// A second of rest, then a sweep in one direction, with noise of 0.01 rad/s on the velocity.
FrictionSamples OneWayAfterRest(unsigned seed) {
  VectorXd v(4000);
  for (Index k = 0; k < v.size(); ++k)
    v(k) = k < 1000 ? 0 : 0.6 - 0.55 * std::cos(2 * 3.14159265358979 * 1e-3 * (k - 1000.0));
  FrictionSamples samples = Noisy(Truth(false), v, 0.1, seed);
  std::mt19937 random(seed + 1);
  std::normal_distribution<double> normal;
  for (double& x : samples.torque.head(1000)) x = 0.1 * normal(random);
  for (double& x : samples.velocity) x += 0.01 * normal(random);
  return samples;
}

TEST(FrictionFit, NoiseAtRestIsNoSecondDirection) {
  for (unsigned seed = 30; seed < 50; ++seed) {
    const FrictionSamples samples = OneWayAfterRest(seed);
    const FrictionFit with = FitFriction(samples, {.offset = true, .folds = 0});
    EXPECT_FALSE(with.Find("coulomb")) << seed;
    EXPECT_FALSE(with.Find("offset")) << seed;
    const FrictionFit without = FitFriction(samples, {.folds = 0});
    EXPECT_NEAR(without["coulomb"].value, 3, 5 * without["coulomb"].deviation) << seed;
    EXPECT_LE(without.samples, 3010) << seed;
  }
}

TEST(FrictionFit, AFewSamplesAreNoSecondDirection) {
  FrictionSamples samples = Noisy(Truth(false), Staircase(100).cwiseAbs(), 0.15, 51, 0.3);
  for (int k = 0; k < 19; ++k) {
    samples.velocity(1000 + k) *= -1;
    samples.torque(1000 + k) *= -1;
  }
  const FrictionFit fit = FitFriction(samples, {.offset = true, .least_velocity = 0.01});
  EXPECT_FALSE(fit.Find("coulomb"));
  const FrictionFit each = FitFriction(samples, {.separate = true, .least_velocity = 0.01});
  EXPECT_FALSE(each.Find("coulomb_negative"));
  EXPECT_EQ(ErrorOf([&] { each["coulomb_negative"]; }),
            "'coulomb_negative' was not identified: only 19 samples slide in the negative "
            "direction, it needs 20");
}

TEST(FrictionFit, NamesADirectionInWhichNothingMoves) {
  const FrictionFit fit = FitFriction(Noisy(Truth(false), Staircase(100).cwiseAbs(), 0.15, 10),
                                      {.separate = true, .least_velocity = 0.01});
  ASSERT_EQ(fit.unidentified.size(), 2u);
  EXPECT_EQ(fit.unidentified[0].name, "coulomb_negative");
  EXPECT_EQ(fit.unidentified[0].reason, "nothing moves in the negative direction");
  EXPECT_NEAR(fit["coulomb_positive"].value, 3, 5 * fit["coulomb_positive"].deviation);
}

TEST(FrictionFit, TakesStictionFromWhatBrokeAway) {
  FrictionSamples samples = Noisy(Truth(false), Staircase(100), 0.15, 11);
  samples.break_away = VectorXd(4);
  samples.break_away << 3.6, -3.4, 3.5, -3.5;
  const FrictionFit fit = FitFriction(samples, {.least_velocity = 0.01});
  EXPECT_DOUBLE_EQ(fit["stiction"].value, 3.5);
  // √(Σ (y − 3.5)²/(4·3)) = √(0.02/12)
  EXPECT_NEAR(fit["stiction"].deviation, std::sqrt(0.02 / 12), 1e-12);
}

TEST(FrictionFit, IntervalsOfTwoThatBrokeAwayHoldTheTruthAsOftenAsTheySay) {
  FrictionSamples samples = Noisy(Truth(false), Staircase(20), 0.15, 52);
  std::mt19937 random(53);
  std::normal_distribution<double> normal;
  for (const int n : {2, 3}) {
    int covered = 0;
    for (int i = 0; i < 200; ++i) {
      samples.break_away = VectorXd(n);
      for (double& y : samples.break_away) y = 3.5 + 0.1 * normal(random);
      const FrictionFit fit = FitFriction(samples, {.least_velocity = 0.01, .folds = 0});
      covered += fit["stiction"].low <= 3.5 && 3.5 <= fit["stiction"].high;
    }
    // A binomial of 200 at 0.95 is below 180 or above 199 once in 500 times.
    EXPECT_GE(covered, 180) << n;
    EXPECT_LE(covered, 199) << n;
  }
  // t of one degree is tan(0.475 π).
  samples.break_away = Eigen::Vector2d(3.4, 3.6);
  const FrictionFit fit = FitFriction(samples, {.least_velocity = 0.01, .folds = 0});
  EXPECT_NEAR(fit["stiction"].high - 3.5, 12.7062 * 0.1, 1e-4);
}

TEST(FrictionFit, SlowSamplesDoNotSlide) {
  FrictionSamples samples = Noisy(Truth(false), Staircase(100), 0.1, 12);
  samples.velocity.head(50).setConstant(0.001);
  samples.torque.head(50).setConstant(-100);
  const FrictionFit fit =
      FitFriction(samples, {.loss = FrictionLoss::None, .least_velocity = 0.01});
  EXPECT_EQ(fit.samples, samples.velocity.size() - 50);
  EXPECT_NEAR(fit["coulomb"].value, 3, 5 * fit["coulomb"].deviation);
}

TEST(FrictionFit, SaysHowManySamplesItNeeds) {
  FrictionSamples samples{.velocity = Eigen::Vector3d(1, 2, 3), .torque = Eigen::Vector3d(1, 2, 3)};
  EXPECT_EQ(ErrorOf([&] { FitFriction(samples, {.least_velocity = 0.01}); }),
            "a fit of 2 parameters needs at least 20 samples faster than 0.01 rad/s, got 3 of 3");
  samples.torque = Eigen::Vector2d(1, 2);
  EXPECT_EQ(ErrorOf([&] { FitFriction(samples, {}); }),
            "there must be a torque for each velocity, 3, got 2");
  samples.torque = Eigen::Vector3d(1, 2, std::nan(""));
  EXPECT_EQ(ErrorOf([&] { FitFriction(samples, {}); }), "velocities and torques must be finite");
  EXPECT_EQ(ErrorOf([&] { FitFriction({.velocity = {}, .torque = {}}, {.folds = 1}); }),
            "folds must be 0 or from 2 to 100, got 1");
}

TEST(FrictionFit, TellsOfABiasThatNoIntervalShows) {
  // A bristle law that is driven through slow reversals follows its steady curve only in part.
  const FrictionParameters p{.coulomb = 3,
                             .viscous = 2.416,
                             .stiction = 4.5,
                             .stribeck_velocity = 0.1,
                             .bristle_stiffness = 300,
                             .bristle_damping = 5};
  const double h = 1e-3;
  FrictionSamples samples{.velocity = VectorXd(40'000), .torque = VectorXd(40'000)};
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  double z = 0;
  for (Index k = 0; k < 40'000; ++k) {
    const double v = 0.3 * std::sin(2 * 3.14159265358979 * 2 * h * static_cast<double>(k));
    const double rate = BristleRate(FrictionLaw::LuGre, p, z, v);
    samples.velocity(k) = v;
    samples.torque(k) =
        p.bristle_stiffness * z + p.bristle_damping * rate + p.viscous * v + 0.15 * normal(random);
    z += h * rate;
  }
  const FrictionFit moving =
      FitFriction(samples, {.model = FrictionModel::LugreStatic, .least_velocity = 0.01});
  EXPECT_TRUE(moving.lacks_fit);
  EXPECT_GT(moving.lack_of_fit, 0.03);
  const FrictionFit steady =
      FitFriction(Noisy(p, Staircase(400, 0.02), 0.15, 14),
                  {.model = FrictionModel::LugreStatic, .least_velocity = 0.01});
  EXPECT_FALSE(steady.lacks_fit) << steady.lack_of_fit;
  EXPECT_LT(steady.lack_of_fit, 0.015);
}

TEST(CompareFriction, PrefersTheModelThatIsTrue) {
  const auto best = [](bool stribeck) {
    const std::vector<FrictionFit> fits =
        CompareFriction(Noisy(Truth(stribeck), Staircase(100), 0.15, 15), {.least_velocity = 0.01});
    EXPECT_EQ(fits.size(), 2u);
    EXPECT_LE(fits[0].bic, fits[1].bic);
    return fits[0].options.model;
  };
  EXPECT_EQ(best(false), FrictionModel::CoulombViscous);
  EXPECT_EQ(best(true), FrictionModel::Stribeck);
}

TEST(CompareFriction, CountsTheSameSamplesForEachModel) {
  // Joints broke away at levels that scatter widely; only the law with stiction is fitted to them.
  FrictionSamples samples = Noisy(Truth(true), Staircase(20, 0.1), 0.15, 54);
  const auto gain = [&] {
    const std::vector<FrictionFit> fits =
        CompareFriction(samples, {.least_velocity = 0.01, .scale = 0.15, .inefficiency = 1});
    EXPECT_EQ(fits[0].options.model, FrictionModel::Stribeck);
    return fits[1].bic - fits[0].bic;
  };
  const double without = gain();
  std::mt19937 random(55);
  std::normal_distribution<double> normal;
  samples.break_away = VectorXd(400);
  for (double& y : samples.break_away) y = 4.5 + normal(random);
  // They hardly move the curve, whose s is known to 0.05 N·m.
  EXPECT_NEAR(gain(), without, 0.2 * without);
}

TEST(FrictionFit, HoldsOutBlocksToValidate) {
  const FrictionFit fit =
      FitFriction(Noisy(Truth(false), Staircase(200), 0.15, 16), {.least_velocity = 0.01});
  // What is held out scatters by σ and by the 0.01 N·m of the parameters.
  EXPECT_NEAR(fit.cross_validation, 0.15, 0.01);
}

TEST(PooledFriction, IsThatOfAllJointsWithoutTheirOffsets) {
  std::vector<FrictionSamples> joints;
  std::vector<FrictionFit> fits;
  const FrictionFitOptions o{.offset = true, .least_velocity = 0.01};
  for (unsigned j = 0; j < 3; ++j) {
    joints.push_back(Noisy(Truth(false), Staircase(100), 0.15, 17 + j, 0.2 * j - 0.2));
    fits.push_back(FitFriction(joints.back(), o));
  }
  const FrictionSamples all = Pooled(joints, fits);
  EXPECT_THAT(all.begin, testing::ElementsAre(0, 2400, 4800));
  const FrictionFit fit = FitFriction(all, {.least_velocity = 0.01});
  EXPECT_NEAR(fit["coulomb"].value, 3, 4 * fit["coulomb"].deviation);
  EXPECT_LT(fit["coulomb"].deviation, 0.7 * fits[0]["coulomb"].deviation);
}

TEST(FrictionFit, IsWrittenAsItsActuatorsReadIt) {
  const FrictionFit fit =
      FitFriction(Noisy(Truth(true), Staircase(100), 0.15, 20),
                  {.model = FrictionModel::Stribeck, .separate = true, .least_velocity = 0.01});
  const Joints joint{"elbow"};
  FrictionFile file{
      .sources = {"a"}, .model = "stribeck", .loss = "cauchy", .directions = "separate"};
  file.joints.push_back(fit.Identified("elbow"));
  const ArmActuators arm =
      WithFriction(ArmActuators::Ideal(joint), joint, ReadFrictionText(file.text(), joint));
  const double mean = 0.5 * (fit["coulomb_positive"].value + fit["coulomb_negative"].value);
  EXPECT_DOUBLE_EQ(arm.joint[0].friction.coulomb, mean);
}

}  // namespace
}  // namespace pliant
