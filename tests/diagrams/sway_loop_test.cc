#include "pliant/diagrams/sway_loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/diagrams/stations.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

const JointPosition kRest{0, 0.3, 3, -2.2, 0, 1, 1.5};

SimulatedArm::Options Gen3(bool ideal) {
  return SimulatedGen3(
      RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf")),
      {.position = kRest, .ideal = ideal, .engine = SimbodyPlant::Engine::Recursive});
}

/// q of ë + 40 ė + 400 e = 0, e = q_d − q, from rest at q_rest: e = (e₀ + (ė₀ + 20 e₀) t) exp(−20
/// t).
PerJoint Position(double t) {
  const PerJoint phi = PerJoint::LinSpaced(kRest.size(), 0, 3);
  const PerJoint e0 = 0.1 * phi.array().sin(), e0_rate = 0.2 * phi.array().cos();
  const PerJoint wanted = kRest.array() + 0.1 * (phi.array() + 2 * t).sin();
  return wanted - std::exp(-20 * t) * (e0 + (e0_rate + 20 * e0) * t);
}

TEST(SmoothSwayLoop, FollowsTheClosedForm) {
  const SimulatedArm::Options arm = Gen3(true);
  const SmoothSwayLoop loop({.model = arm.model,
                             .position = kRest,
                             .rotor_inertia = arm.actuators.reflected_inertia(),
                             .engine = arm.engine});
  Simulator sim(loop.diagram, {.integrator = {.method = Method::kDormandPrince,
                                              .relative_tolerance = 1e-10,
                                              .absolute_tolerance = 1e-12}});
  for (const double t : {0.02, 0.1, 0.5, 1.0}) {
    sim.AdvanceTo(t);
    EXPECT_LT((sim.Get(loop.arm->position) - Position(t)).cwiseAbs().maxCoeff(), 1e-9)
        << "t = " << t;  // the tolerance, summed over some tens of steps
  }
}

// Held for h = 1 ms the torque is late by h/2, which moves the poles by 20 h/2 = 1 %, and the arm
// by as much of its largest error, 0.1 rad.
TEST(SwayLoop, OfAnIdealArmIsLateByHalfASample) {
  const SwayLoop loop({.arm = Gen3(true)});
  Simulator sim(loop.diagram);
  for (const double t : {0.02, 0.1, 0.5, 1.0}) {
    sim.AdvanceTo(t);
    EXPECT_LT((sim.Get(loop.arm->position) - Position(t)).cwiseAbs().maxCoeff(), 2e-3)
        << "t = " << t;
  }
}

TEST(SwayLoop, AccountsForTheEnergyOfTheFullStation) {
  SimulatedArm::Options arm = Gen3(false);
  arm.firmware.mode = ControlMode::Current;
  const SwayLoop loop({.arm = arm, .account = true});
  Simulator sim(loop.diagram, {.integrator = {.method = Method::kCashKarp}});
  const double start = sim.Get(loop.arm->energy);
  sim.AdvanceTo(0.5);
  const double heat = sim.Get(loop.heat->y);
  EXPECT_GT(heat, 0.1);  // friction of several N·m at some 0.2 rad/s
  EXPECT_NEAR(sim.Get(loop.arm->energy) - start, sim.Get(loop.work->y) - heat,
              1e-5 * heat);  // ten times the relative tolerance
}

}  // namespace
}  // namespace pliant
