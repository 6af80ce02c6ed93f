#include "pliant/systems/linear_system.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/tests/support/block_laws.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Matrix2d;
using Eigen::MatrixXd;

const Joints kTwo{"shoulder", "elbow"};
/// q̈ = u − q, of which q is shown.
const LinearModel kSpring{Matrix2d{{0, 1}, {-1, 0}}, Eigen::Vector2d(0, 1),
                          Eigen::RowVector2d(1, 0)};

TEST(LinearSystem, FollowsItsClosedForm) {
  BlockTester<LinearSystem<double, double>> t(
      {.model = kSpring, .initial = Eigen::Vector2d(1, 0)},
      {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12}});
  t.Set(t->u, 3);
  for (const double time : {0.5, 1.0, 4.0}) {
    t.AdvanceTo(time);
    // Errors of steps, each at most the tolerance, do not grow on a circle.
    EXPECT_NEAR(t.Get(t->y), 3 - 2 * std::cos(time), 1e-7);
    EXPECT_NEAR(t.Get(t->x)(1), 2 * std::sin(time), 1e-7);
  }
}

TEST(LinearSystem, CarriesTypedSignals) {
  BlockTester<LinearSystem<JointTorque, JointVelocity>> t(
      {.input = kTwo,
       .output = kTwo,
       .states = {"a", "b"},
       .model = {-Matrix2d::Identity(), 2 * Matrix2d::Identity(), Matrix2d{{0, 1}, {1, 0}},
                 10 * Matrix2d::Identity()},
       .initial = Eigen::Vector2d(5, 6)});
  t.Set(t->u, {1.0, 2.0});
  EXPECT_EQ(t.Get(t->y), (JointVelocity{16.0, 25.0}));
}

TEST(LinearSystem, WithoutDClosesALoop) {
  DiagramBuilder b;
  auto& plant = b.Add<LinearSystem<double, double>>(
      "plant", {.model = {MatrixXd::Zero(1, 1), MatrixXd::Ones(1, 1), MatrixXd::Ones(1, 1)},
                .initial = Eigen::VectorXd::Ones(1)});
  auto& gain = b.Add<Gain<double>>("gain", {.gain = -1});
  b.Connect(plant.y, gain.u);
  b.Connect(gain.y, plant.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(1);
  EXPECT_NEAR(sim.Get(plant.y), std::exp(-1), 1e-5);  // ten times the relative tolerance
}

TEST(LinearSystem, KeepsTheLawsOfBlocks) {
  ExpectBlockLaws(BlockTester<LinearSystem<double, double>>({.model = kSpring}));
  ExpectBlockLaws(BlockTester<LinearSystem<JointTorque, JointVelocity>>(
      {.input = kTwo,
       .output = kTwo,
       .model = {-Matrix2d::Identity(), Matrix2d::Identity(), Matrix2d::Identity(),
                 Matrix2d::Identity()}}));
}

TEST(LinearSystem, RefusesWhatDoesNotFitItsPorts) {
  const auto error = [](const LinearSystem<double, double>::Options& o) {
    return ErrorOf([&] { BlockTester<LinearSystem<double, double>>{o}; });
  };
  LinearModel wide = kSpring;
  wide.B = Matrix2d::Identity();
  EXPECT_EQ(error({.model = wide}), "block: B must be 2×1, as the states and u are, got 2×2");
  LinearModel tall = kSpring;
  tall.C = Matrix2d::Identity();
  EXPECT_EQ(error({.model = tall}), "block: C must be 1×2, as y and the states are, got 2×2");
  EXPECT_EQ(error({.states = {"x"}, .model = kSpring}),
            "block: states must be as many as the rows of A, 2, got 1");
  EXPECT_EQ(error({.model = kSpring, .initial = Eigen::Vector3d::Zero()}),
            "block: initial must have a number for each state, 2, got 3");
  EXPECT_EQ(error({.model = kSpring, .initial = Eigen::Vector2d(0, NAN)}),
            "block: initial must be finite");
}

}  // namespace
}  // namespace pliant
