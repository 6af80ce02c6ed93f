// Arms that move freely under gravity, by both engines.

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <vector>

#include "pliant/plants/simbody_arm.h"
#include "pliant/systems/integrator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {
namespace {

/// q̇ = v, v̇ = (M + B)⁻¹ (−C v − g), with y = (q, v).
struct FreeMotion {
  FreeMotion(const RobotModel& m, bool use_simbody, double rotor_inertia)
      : model{m},
        arm{m},
        dynamics(m),
        simbody{use_simbody},
        B{PerJoint::Constant(m.size(), rotor_inertia)} {}

  bool operator()(double, std::span<const double> y, std::span<double> rate) {
    const int n = model.size();
    const JointPosition q = Eigen::Map<const Eigen::VectorXd>(y.data(), n);
    const JointVelocity v = Eigen::Map<const Eigen::VectorXd>(y.data() + n, n);
    const JointTorque none = JointTorque::Zero(model.joints());
    if (!simbody) ComputeDynamics(model, q, v, dynamics);
    const JointAcceleration a = simbody ? arm.ForwardDynamics(q, v, none, {}, B, workspace)
                                        : ForwardDynamics(dynamics, none, none, B);
    Eigen::Map<Eigen::VectorXd>(rate.data(), n) = v;
    Eigen::Map<Eigen::VectorXd>(rate.data() + n, n) = a;
    return true;
  }

  RobotModel model;
  SimbodyArm arm;
  SimbodyArm::Workspace workspace;
  RobotDynamics dynamics;
  bool simbody;
  PerJoint B;
};

/// Energies and states every 10 ms of a motion from a posture at rest.
struct Motion {
  std::vector<double> kinetic, total;
  std::vector<std::vector<double>> state;
};

Motion Fall(const RobotModel& model, bool simbody, double seconds, double rotor_inertia) {
  const int n = model.size();
  FreeMotion f(model, simbody, rotor_inertia);
  const auto integrator = MakeIntegrator(
      {.method = Method::kDormandPrince, .relative_tolerance = 1e-12, .absolute_tolerance = 1e-12},
      2 * n, Derivatives(f));
  std::vector<double> y(static_cast<std::size_t>(2 * n), 0.0);
  for (int i = 0; i < n; ++i) y[static_cast<std::size_t>(i)] = 0.3 + 0.1 * i;
  integrator->Reset(0, y, 0);
  Motion motion;
  RobotDynamics d(model);
  for (int tick = 1; tick <= static_cast<int>(100 * seconds); ++tick) {
    double t = 0;
    while (t < 0.01 * tick) t = integrator->Step(0.01 * tick);
    integrator->Interpolate(t, y);
    ComputeDynamics(model, Eigen::Map<Eigen::VectorXd>(y.data(), n),
                    Eigen::Map<Eigen::VectorXd>(y.data() + n, n), d);
    motion.kinetic.push_back(KineticEnergy(d) + 0.5 * rotor_inertia * d.v.squaredNorm());
    motion.total.push_back(motion.kinetic.back() + PotentialEnergy(model, d));
    motion.state.push_back(y);
  }
  return motion;
}

using Arm = std::pair<RobotModel (*)(), bool>;

class FreeMotionOf : public ::testing::TestWithParam<Arm> {};

TEST_P(FreeMotionOf, KeepsItsEnergyForTenSeconds) {
  const auto [make, simbody] = GetParam();
  const Motion motion = Fall(make(), simbody, 10, 0);
  const double largest = *std::ranges::max_element(motion.kinetic);
  const auto [low, high] = std::ranges::minmax_element(motion.total);
  EXPECT_GT(largest, 5);  // [J]: it does fall
  EXPECT_LT((*high - *low) / largest, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Arms, FreeMotionOf,
                         ::testing::Values(Arm{&Gen3, false}, Arm{&Gen3, true}, Arm{&Lwr, false},
                                           Arm{&Lwr, true}),
                         [](const auto& test) {
                           return test.param.first().name() +
                                  (test.param.second ? "_simbody" : "_recursive");
                         });

TEST(FreeMotion, IsTheSameInBothEngines) {
  // Rotors keep the motion slow enough that it is not chaotic within two seconds: what is left is
  // the integrator's tolerance.
  for (const auto make : {&Gen3, &Lwr}) {
    const Motion a = Fall(make(), false, 2, 0.3), b = Fall(make(), true, 2, 0.3);
    for (std::size_t k = 0; k < a.state.back().size(); ++k)
      EXPECT_NEAR(a.state.back()[k], b.state.back()[k], 1e-9) << "state " << k;
  }
}

TEST(FreeMotion, WithRotorsKeepsItsEnergy) {
  for (const bool simbody : {false, true}) {
    const Motion motion = Fall(Gen3(), simbody, 2, 0.3);
    const auto [low, high] = std::ranges::minmax_element(motion.total);
    EXPECT_LT((*high - *low) / *std::ranges::max_element(motion.kinetic), 1e-8);
  }
}

}  // namespace
}  // namespace pliant
