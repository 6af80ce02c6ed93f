#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/estimators/complementary_fusion.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/estimators/super_twisting_fusion.h"
#include "pliant/estimators/super_twisting_observer.h"
#include "pliant/systems/random.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/statistics.h"

// An hour of an arm at rest under a constant load, with noise in all that is measured. No estimate
// drifts: what it deviates by is bounded, and its means over 10 s scatter about the load as much
// at the end as at the start.
namespace pliant {
namespace {

const Joints kJoints = Joints::Numbered(1);
constexpr double kPeriod = 1e-3, kLoad = 5, kGain = 20;
constexpr int kBatch = 10'000, kBatches = 360;

/// Half-widths of uniform noise.
struct Noise {
  double p, tau, sensor;
};

/// What is measured of an arm whose motors carry a load: p = 0, τ = −load, τ_s = load.
class Measurements final : public Block {
 public:
  explicit Measurements(const Noise& noise)
      : dynamics{this, "dynamics", kJoints, AtRest()}, noise_{noise} {
    Every(1ms).Compute(dynamics).From(clock).As(&Measurements::Move);
    Every(1ms).Compute(torque).From(clock).As(&Measurements::Carry);
    Every(1ms).Compute(sensor_torque).From(clock).As(&Measurements::Sense);
  }

  Output<RobotDynamics> dynamics;
  Output<JointTorque> torque{this, "torque", kJoints};
  Output<JointTorque> sensor_torque{this, "sensor_torque", kJoints};

 private:
  static RobotDynamics AtRest() {
    RobotDynamics d;
    d.p = JointMomentum::Zero(kJoints);
    d.v = JointVelocity::Zero(kJoints);
    d.coriolis_transposed = d.gravity = JointTorque::Zero(kJoints);
    return d;
  }
  double Draw(std::uint64_t part, double t) const {
    return 2 * RandomStream(81).Part(part).Uniform(TickAt(t, kPeriod)) - 1;
  }
  void Move(RobotDynamics& d, double t) const { d.p(0) = noise_.p * Draw(1, t); }
  JointTorque Carry(double t) const { return {-kLoad + noise_.tau * Draw(2, t)}; }
  JointTorque Sense(double t) const { return {kLoad + noise_.sensor * Draw(3, t)}; }

  const Noise noise_;
};

/// How an estimate goes about the load over an hour, the first 10 s left out.
struct Hour {
  double worst = 0;
  Eigen::VectorXd means = Eigen::VectorXd::Zero(kBatches);  // of 10 s, less the load

  double deviation() const { return std::sqrt(Variance(means)); }
};

/// Adds an estimator, runs it for an hour and ten seconds, and watches what `add` returns.
template <class Add>
Hour HourOf(const Noise& noise, const Add& add) {
  DiagramBuilder b;
  auto& measured = b.Add<Measurements>("measured", noise);
  const Output<JointTorque>& estimate = add(b, measured);
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  Hour hour;
  for (int k = 0; k < kBatch; ++k) sim.AdvanceThroughTick();
  for (int i = 0; i < kBatches; ++i)
    for (int k = 0; k < kBatch; ++k) {
      sim.AdvanceThroughTick();
      const double error = sim.Get(estimate)(0) - kLoad;
      hour.worst = std::max(hour.worst, std::abs(error));
      hour.means(i) += error / kBatch;
    }
  return hour;
}

MomentumObserver& AddObserver(DiagramBuilder& b, const Measurements& measured) {
  auto& observer = b.Add<MomentumObserver>(
      "observer", {.joints = kJoints, .gain = PerJoint::Constant(1, kGain), .period = 1ms});
  b.Connect(measured.dynamics, observer.dynamics);
  b.Connect(measured.torque, observer.torque);
  return observer;
}

template <class T>
T& AddSuperTwisting(DiagramBuilder& b, const Measurements& measured, double L) {
  auto& observer =
      b.Add<T>("observer", {.joints = kJoints, .rate = PerJoint::Constant(1, L), .period = 1ms});
  b.Connect(measured.dynamics, observer.dynamics);
  b.Connect(measured.torque, observer.torque);
  return observer;
}

/// Batches are many time constants long, so their means are nearly independent.
void ExpectNoDrift(const Hour& hour) {
  const Eigen::Index half = kBatches / 2;
  const double one = hour.deviation();
  EXPECT_LT(std::abs(hour.means.mean()), one * MeanBound(kBatches));
  EXPECT_LT(std::abs(hour.means.tail(half).mean() - hour.means.head(half).mean()),
            one * std::sqrt(2) * MeanBound(half));
}

constexpr Noise kSmall{.p = 1e-5, .tau = 0.05, .sensor = 0.05};
constexpr Noise kLarge{.p = 5e-3, .tau = 0.3, .sensor = 1};  // of a Gen3's sensors

// r_k − load = (1 − d) Σ d^{k−j} (m_j + (n_j − n_{j−1})/h): the n telescope.
double ObserverBound(const Noise& noise) {
  return -std::expm1(-kGain * kPeriod) / kPeriod * 2 * noise.p + noise.tau;
}

// The mean of 10 s of a filter with gain 1 at rest has the deviation of the mean of its input; of
// n_j − n_{j−1} only the ends are left, and of the filter's memory 1/(1 − d) samples.
TEST(MomentumObserver, DoesNotDriftInAnHour) {
  const Hour hour =
      HourOf(kLarge, [](DiagramBuilder& b, const Measurements& m) -> const Output<JointTorque>& {
        return AddObserver(b, m).residual;
      });
  EXPECT_LE(hour.worst, ObserverBound(kLarge));
  ExpectNoDrift(hour);
  const double mean = kLarge.tau / std::sqrt(3.0 * kBatch);
  const double ends = 2 * ObserverBound(kLarge) / (-std::expm1(-kGain * kPeriod) * kBatch);
  EXPECT_LT(hour.deviation(), mean * (1 + VarianceBound(kBatches)) + ends);
}

// τ̂_e − load = (r − load) + (τ_s − load) − (l − load)
TEST(ComplementaryFusion, DoesNotDriftInAnHour) {
  const Hour hour =
      HourOf(kLarge, [](DiagramBuilder& b, const Measurements& m) -> const Output<JointTorque>& {
        auto& fusion = b.Add<ComplementaryFusion>(
            "fusion", {.joints = kJoints, .gain = PerJoint::Constant(1, kGain), .period = 1ms});
        b.Connect(AddObserver(b, m).residual, fusion.residual);
        b.Connect(m.sensor_torque, fusion.sensor_torque);
        return fusion.external_torque;
      });
  EXPECT_LE(hour.worst, ObserverBound(kLarge) + 2 * kLarge.sensor);
  ExpectNoDrift(hour);
}

// Noise that changes by less than h k₃ in a sample passes, and no more: σ_k = τ̄_k.
TEST(SuperTwistingObserver, DoesNotDriftInAnHour) {
  const double L = 200, noise = 2 * kSmall.p / kPeriod + kSmall.tau;
  ASSERT_LT(2 * noise, kPeriod * 1.1 * L);
  const Hour hour =
      HourOf(kSmall, [](DiagramBuilder& b, const Measurements& m) -> const Output<JointTorque>& {
        return AddSuperTwisting<SuperTwistingObserver>(b, m, 200).residual;
      });
  EXPECT_LE(hour.worst, noise * (1 + 1e-9));
  ExpectNoDrift(hour);
}

// The law is odd and the noise symmetric, so the mean is the load also where noise keeps σ from
// sliding.
TEST(SuperTwistingObserver, DoesNotDriftInAnHourOfMoreNoiseThanItLetsThrough) {
  const Hour hour =
      HourOf(kLarge, [](DiagramBuilder& b, const Measurements& m) -> const Output<JointTorque>& {
        return AddSuperTwisting<SuperTwistingObserver>(b, m, 50).residual;
      });
  ExpectNoDrift(hour);
  EXPECT_GT(hour.worst, kPeriod * 1.1 * 50) << "it does not slide";
}

// σ_k is τ̄_k less the mean of two readings, so τ̂_e − load = τ̄_k − load + ½ (τ_s,k − τ_s,k−1).
TEST(SuperTwistingFusion, DoesNotDriftInAnHour) {
  const double L = 300, noise = 2 * kSmall.p / kPeriod + kSmall.tau + kSmall.sensor;
  ASSERT_LT(2 * noise, kPeriod * 1.1 * L);
  const Hour hour =
      HourOf(kSmall, [](DiagramBuilder& b, const Measurements& m) -> const Output<JointTorque>& {
        auto& fusion = AddSuperTwisting<SuperTwistingFusion>(b, m, 300);
        b.Connect(m.sensor_torque, fusion.sensor_torque);
        return fusion.external_torque;
      });
  EXPECT_LE(hour.worst, noise * (1 + 1e-9));
  ExpectNoDrift(hour);
}

}  // namespace
}  // namespace pliant
