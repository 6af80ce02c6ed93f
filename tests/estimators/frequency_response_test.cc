#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "pliant/estimators/complementary_fusion.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/estimators/super_twisting_observer.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"

// What sampling makes of the estimators' transfer functions. With x = jωh, y = Kh, d = e^{−y} and
// φ(z) = (1 − e^{−z})/z, a momentum whose rate is e^{jωt} shows (p_k − p_{k−1})/h = φ(x) e^{jωkh},
// and so
//
//   observer:  H = D φ(x),   D = (1 − d)/(1 − d e^{−x});       continuous: C = y/(x + y)
//   sensor:    S = 1 − D ½(1 + e^{−x});                        continuous: 1 − C
//   sum:       H + S
//
// H/C = φ(x) φ(y)/φ(x + y), and as ln φ(z) = −z/2 + z²/24 − z⁴/2880 + …, the halves cancel:
//
//   H/C − 1 = −xy/12 + …:  a phase of K ω h²/12, and nothing of the gain to that order
//   (1 − S)/C − 1 = (H/C)(x/2) coth(x/2) − 1 = −(ωh)²/12 − xy/12 + …
//   |H + S − 1| = |D| [sin a/a − cos a] ≤ |D| (ωh)²/12,   a = ωh/2
//
// What comes next in the first two is less than (ωh)²/40 + Kh of these terms up to ωh = 0.8 π.
namespace pliant {
namespace {

using Complex = std::complex<double>;

const Joints kJoints = Joints::Numbered(2);
const PerJoint kGain = PerJoint::LinSpaced(2, 10, 50);
constexpr double kPeriod = 1e-3;

/// A unit mass on which a sin ωt acts, p = (1 − cos ωt) a/ω, and a sensor that measures it.
class Wave final : public Block {
 public:
  explicit Wave(Duration period) : dynamics{this, "dynamics", kJoints, AtRest()} {
    Every(period)
        .Compute(dynamics)
        .From(clock, omega, amplitude)
        .As([](RobotDynamics& d, double t, double w, double a) {
          d.p.setConstant(a / w * (1 - std::cos(w * t)));
        });
    Every(period).Compute(force).From(clock, omega, amplitude).As([](double t, double w, double a) {
      return JointTorque(PerJoint::Constant(2, a * std::sin(w * t)));
    });
  }

  Input<double> omega{this, "omega", {}, 1};
  Input<double> amplitude{this, "amplitude", {}, 1};
  Output<RobotDynamics> dynamics;
  Output<JointTorque> force{this, "force", kJoints};

 private:
  static RobotDynamics AtRest() {
    RobotDynamics d;
    d.p = JointMomentum::Zero(kJoints);
    d.v = JointVelocity::Zero(kJoints);
    d.coriolis_transposed = d.gravity = JointTorque::Zero(kJoints);
    return d;
  }
};

/// Whole numbers of periods in `samples` of 1 ms, evenly spread in the logarithm.
std::vector<int> Periods(int samples, double least_hz, double most_hz, int count) {
  std::vector<int> periods;
  for (int i = 0; i < count; ++i) {
    const double hz = least_hz * std::pow(most_hz / least_hz, i / (count - 1.0));
    periods.push_back(static_cast<int>(std::lround(hz * samples * kPeriod)));
  }
  return periods;
}

TEST(FrequencyResponse, OfObserverAndFusionIsThatOfTheSampledAndNearlyThatOfTheContinuousFilter) {
  DiagramBuilder b;
  auto& wave = b.Add<Wave>("wave", Duration(1ms));
  auto& none =
      b.Add<Constant<JointTorque>>("none", {.space = kJoints, .value = JointTorque::Zero(kJoints)});
  auto& observer =
      b.Add<MomentumObserver>("observer", {.joints = kJoints, .gain = kGain, .period = 1ms});
  const ComplementaryFusion::Options o{.joints = kJoints, .gain = kGain, .period = 1ms};
  auto& sensor = b.Add<ComplementaryFusion>("sensor", o);
  auto& fusion = b.Add<ComplementaryFusion>("fusion", o);
  b.Connect(wave.dynamics, observer.dynamics);
  b.Connect(none.y, observer.torque);
  b.Connect(none.y, sensor.residual);
  b.Connect(wave.force, sensor.sensor_torque);
  b.Connect(observer.residual, fusion.residual);
  b.Connect(wave.force, fusion.sensor_torque);
  const Diagram diagram = b.Build();

  // Whole periods: a sine has no part in the others' correlations. What is left of the start is
  // e^{−10 · 4}.
  const int settle = 4000, samples = 10'000;
  for (const int periods : Periods(samples, 0.1, 400, 19)) {
    const double w = 2 * std::numbers::pi * periods / (samples * kPeriod);
    Simulator sim(diagram);
    sim.Set(wave.omega, w);
    std::array<std::array<Complex, 2>, 3> found{};
    for (int k = 0; k < settle + samples; ++k) {
      sim.AdvanceThroughTick();
      if (k < settle) continue;
      const Complex back = Complex(0, 2.0 / samples) * std::exp(Complex(0, -w * k * kPeriod));
      for (const int j : {0, 1}) {
        const auto i = static_cast<std::size_t>(j);
        found[0][i] += back * sim.Get(observer.residual)(j);
        found[1][i] += back * sim.Get(sensor.external_torque)(j);
        found[2][i] += back * sim.Get(fusion.external_torque)(j);
      }
    }
    for (const std::size_t j : {0u, 1u}) {
      SCOPED_TRACE(testing::Message()
                   << w / (2 * std::numbers::pi) << " Hz, K = " << kGain(int(j)));
      const double wh = w * kPeriod, y = kGain(static_cast<int>(j)) * kPeriod, d = std::exp(-y);
      const Complex x(0, wh), back = std::exp(-x);
      const Complex C = y / (x + y), D = (1 - d) / (1.0 - d * back);
      const Complex H = D * (1.0 - back) / x, S = 1.0 - D * 0.5 * (1.0 + back);
      // Round-off of p, 1/ω, over h, and of ten thousand terms.
      const double round_off = 1e-15 / (w * kPeriod) + 1e-12;
      EXPECT_LT(std::abs(found[0][j] - H), round_off);
      EXPECT_LT(std::abs(found[1][j] - S), round_off);
      EXPECT_LT(std::abs(found[2][j] - (H + S)), round_off);

      const double more = 1 + wh * wh / 40 + y;
      EXPECT_LE(std::abs(found[0][j] / C - 1.0), wh * y / 12 * more + round_off / std::abs(C));
      EXPECT_LE(std::abs(found[1][j] - (1.0 - C)),
                std::abs(C) * (wh * wh / 12 + wh * y / 12) * more + round_off);
      EXPECT_LE(std::abs(found[2][j] - 1.0), std::abs(D) * wh * wh / 12 + round_off);
      // The phase is what sampling adds; the gain changes by second order only.
      EXPECT_NEAR(std::arg(found[0][j] / C), -wh * y / 12,
                  wh * y / 12 * (more - 1) + round_off / std::abs(C));
      EXPECT_LE(std::abs(std::abs(found[0][j] / C) - 1),
                wh * y / 12 * (wh + y) + round_off / std::abs(C));
    }
  }
}

/// The largest error of a super-twisting observer of rate L that follows a sin ωt for two seconds
/// or 40 periods, if those are longer.
double Error(double L, double w, double a, Duration period) {
  DiagramBuilder b;
  auto& wave = b.Add<Wave>("wave", period);
  auto& none =
      b.Add<Constant<JointTorque>>("none", {.space = kJoints, .value = JointTorque::Zero(kJoints)});
  auto& observer = b.Add<SuperTwistingObserver>(
      "observer", {.joints = kJoints, .rate = PerJoint::Constant(2, L), .period = period});
  b.Connect(wave.dynamics, observer.dynamics);
  b.Connect(none.y, observer.torque);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  sim.Set(wave.omega, w);
  sim.Set(wave.amplitude, a);
  double worst = 0;
  const double length = std::max(2.0, 2 * std::numbers::pi / w);
  while (sim.time() < length) {
    sim.AdvanceThroughTick();
    worst = std::max(worst, std::abs(sim.Get(observer.residual)(0) - sim.Get(wave.force)(0)));
  }
  return worst;
}

// σ_k is the mean of the last sample, and the torque has moved on by no more than ½ h L since.
TEST(FrequencyResponse,
     OfSuperTwistingIsOneToFirstOrderWhereAmplitudeTimesFrequencyIsWithinItsRate) {
  const double L = 100;
  for (const int periods : Periods(10'000, 0.1, 400, 10)) {
    const double w = 2 * std::numbers::pi * periods / 10, a = L / w;
    const double round_off = 1e-15 * a / (w * kPeriod) + 1e-12;
    const double coarse = Error(L, w, a, 1ms), fine = Error(L, w, a, 500us);
    EXPECT_LE(coarse, 0.5 * kPeriod * L + round_off) << periods / 10.0 << " Hz";
    EXPECT_LE(fine, 0.25 * kPeriod * L + 2 * round_off) << periods / 10.0 << " Hz";
    // and no less than that where the sample is short: its end is ½ h from its middle
    if (w * kPeriod < 0.1) {
      EXPECT_GE(fine, 0.25 * kPeriod * L * 0.99) << periods / 10.0 << " Hz";
    }
  }
}

// In half a period σ moves by no more than k₃ π/ω, and the torque by 2 a.
TEST(FrequencyResponse, OfSuperTwistingFallsBehindWhatIsFasterThanItsRate) {
  const double L = 100;
  for (const double w : {1.0, 10.0, 100.0}) {
    const double a = 3 * L / w;
    EXPECT_GE(Error(L, w, a, 1ms), a - 0.5 * 1.1 * L * std::numbers::pi / w) << w;
  }
}

}  // namespace
}  // namespace pliant
