#include "pliant/analysis/linearize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pliant/controllers/lqr.h"
#include "pliant/controllers/state_feedback.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/low_pass.h"
#include "pliant/systems/multiplexer.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A damped pendulum on a stiff rod, and a force gauge that feels the torque directly:
///
///   θ̇ = ω,   m l² ω̇ = τ − d ω − m g l sin θ,   height = −l cos θ,   gauge = k τ + ω
class Pendulum final : public Block {
 public:
  Pendulum()
      : torque{this, "torque", {}, 0.0},
        height{this, "height"},
        gauge{this, "gauge"},
        angle{this, "angle"},
        speed{this, "speed"} {
    Derivative(angle).From(speed).As([](double w) { return w; });
    Derivative(speed).From(angle, speed, torque).As([](double a, double w, double tau) {
      return (tau - d * w - m * g * l * std::sin(a)) / (m * l * l);
    });
    Compute(height).From(angle).As([](double a) { return -l * std::cos(a); });
    Compute(gauge).From(torque, speed).As([](double tau, double w) { return k * tau + w; });
  }

  Input<double> torque;
  Output<double> height, gauge;
  Continuous<double> angle, speed;

  static constexpr double m = 2, l = 0.7, d = 0.3, g = 9.81, k = 0.2;
};

/// A cart by Euler steps: p⁺ = p + h v, v⁺ = v + h u.
class SampledCart final : public Block {
 public:
  SampledCart()
      : force{this, "force", {}, 0.0}, p{this, "p"}, v{this, "v"}, position{this, "position"} {
    Every(10ms).Update(p).From(p, v).As([](double x, double w) { return x + 0.01 * w; });
    Every(10ms).Update(v).From(v, force).As([](double w, double u) { return w + 0.01 * u; });
    Compute(position).From(p).As([](double x) { return x; });
  }

  Input<double> force;
  Discrete<double> p, v;
  Output<double> position;
};

/// y = u, an input of a diagram.
class Terminal final : public Block {
 public:
  Terminal() : u{this, "u", {}, 0.0}, y{this, "y"} {
    Compute(y).From(u).As([](double now) { return now; });
  }

  Input<double> u;
  Output<double> y;
};

struct HangingPendulum {
  DiagramBuilder b;
  Pendulum& pendulum = b.Add<Pendulum>("pendulum");
  Diagram diagram = b.Build();
};

// h = (3 ε)^(1/3) = 9e-6, |f|, |f‴| ≤ 30: h² |f‴|/6 + ε |f|/h < 1.2e-9.
constexpr double kOfDifferences = 2e-9;

TEST(Linearize, GivesThePendulumsJacobians) {
  HangingPendulum x;
  const Pendulum& p = x.pendulum;
  Context about = x.diagram.MakeContext();
  about.Set(p.angle, 0.6);
  about.Set(p.speed, -1.5);
  about.Set(p.torque, 2.0);

  const Linearization lin =
      Linearize(x.diagram, about, {.inputs = {p.torque}, .outputs = {p.height, p.gauge}});

  const double inertia = p.m * p.l * p.l;
  const Eigen::Matrix2d A{{0, 1}, {-p.g / p.l * std::cos(0.6), -p.d / inertia}};
  const Eigen::Vector2d B{0, 1 / inertia};
  const Eigen::Matrix2d C{{p.l * std::sin(0.6), 0}, {0, 1}};
  const Eigen::Vector2d D{0, p.k};
  EXPECT_LT((lin.A - A).lpNorm<Eigen::Infinity>(), kOfDifferences) << lin.A;
  EXPECT_LT((lin.B - B).lpNorm<Eigen::Infinity>(), kOfDifferences) << lin.B;
  EXPECT_LT((lin.C - C).lpNorm<Eigen::Infinity>(), kOfDifferences) << lin.C;
  EXPECT_LT((lin.D - D).lpNorm<Eigen::Infinity>(), kOfDifferences) << lin.D;
  EXPECT_THAT(lin.states, ElementsAre("pendulum.angle", "pendulum.speed"));
  EXPECT_THAT(lin.inputs, ElementsAre("pendulum.torque"));
  EXPECT_THAT(lin.outputs, ElementsAre("pendulum.height", "pendulum.gauge"));
}

TEST(Linearize, LeavesTheContextAsItWas) {
  HangingPendulum x;
  Context about = x.diagram.MakeContext();
  about.Set(x.pendulum.angle, 0.6);
  const Context before = about;
  Linearize(x.diagram, about, {.inputs = {x.pendulum.torque}, .outputs = {x.pendulum.height}});
  EXPECT_TRUE(about == before);
}

TEST(Linearize, WithoutPortsGivesAAlone) {
  HangingPendulum x;
  const Linearization lin = Linearize(x.diagram, x.diagram.MakeContext(), {});
  EXPECT_EQ(lin.A.rows(), 2);
  EXPECT_EQ(lin.B.cols(), 0);
  EXPECT_EQ(lin.C.rows(), 0);
}

TEST(Linearize, NamesTheElementsOfVectors) {
  const Joints joints{"shoulder", "elbow"};
  DiagramBuilder b;
  auto& filter =
      b.Add<LowPass<JointVelocity>>("filter", {.space = joints, .cutoff_hz = 5, .period = 1ms});
  auto& pendulum = b.Add<Pendulum>("pendulum");
  auto& rest = b.Add<Constant<JointVelocity>>("rest", {.space = joints, .value = {0.0, 0.0}});
  b.Connect(rest.y, filter.u);
  const Diagram diagram = b.Build();
  const Linearization lin = Linearize(diagram, diagram.MakeContext(),
                                      {.inputs = {pendulum.torque}, .outputs = {filter.y}});
  EXPECT_THAT(lin.outputs, ElementsAre("filter.y[shoulder]", "filter.y[elbow]"));
  EXPECT_EQ(lin.C.norm(), 0);  // a held output does not follow the state between ticks
}

TEST(Linearize, RefusesAnInputThatFollows) {
  HangingPendulum x;
  EXPECT_THAT(ErrorOf([&] {
                Linearize(x.diagram, x.diagram.MakeContext(), {.inputs = {x.pendulum.height}});
              }),
              HasSubstr("cannot set pendulum.height"));
}

TEST(LinearizeSampled, GivesTheMatricesOfTheSampledCart) {
  DiagramBuilder b;
  auto& cart = b.Add<SampledCart>("cart");
  const Diagram diagram = b.Build();
  const Linearization lin = LinearizeSampled(diagram, diagram.MakeContext(),
                                             {.inputs = {cart.force}, .outputs = {cart.position}});
  const Eigen::Matrix2d A{{1, 0.01}, {0, 1}};
  // Linear: only the round-off of the difference, ε |f|/h.
  EXPECT_LT((lin.A - A).lpNorm<Eigen::Infinity>(), 1e-10) << lin.A;
  EXPECT_LT((lin.B - Eigen::Vector2d{0, 0.01}).lpNorm<Eigen::Infinity>(), 1e-10) << lin.B;
  EXPECT_LT((lin.C - A.topRows(1)).lpNorm<Eigen::Infinity>(), 1e-10) << lin.C;
  EXPECT_NEAR(lin.D(0), 0, 1e-10);
  EXPECT_THAT(lin.states, ElementsAre("cart.p", "cart.v"));
}

TEST(LinearizeSampled, GivesThePoleOfALowPass) {
  DiagramBuilder b;
  auto& source = b.Add<Terminal>("source");
  auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 5, .period = 1ms});
  b.Connect(source.y, filter.u);
  const Diagram diagram = b.Build();
  const Linearization lin = LinearizeSampled(diagram, diagram.MakeContext(),
                                             {.inputs = {source.u}, .outputs = {filter.y}});
  const double pole = std::exp(-2 * std::numbers::pi * 5 * 1e-3);
  EXPECT_NEAR(lin.A(0, 0), pole, 1e-10);
  EXPECT_NEAR(lin.D(0, 0), 1 - pole, 1e-10);
}

TEST(LinearizeSampled, RefusesWhatIsIntegrated) {
  HangingPendulum x;
  EXPECT_THAT(ErrorOf([&] { LinearizeSampled(x.diagram, x.diagram.MakeContext(), {}); }),
              HasSubstr("this one integrates pendulum.angle"));
}

TEST(FindEquilibrium, GivesTheTorqueThatHoldsThePendulum) {
  HangingPendulum x;
  const Pendulum& p = x.pendulum;
  Context start = x.diagram.MakeContext();
  start.Set(p.angle, 0.5);
  Context still = FindEquilibrium(x.diagram, start, {p.torque});
  // |ω̇| ≤ 1e-9 leaves 1e-9 m l² of torque.
  EXPECT_NEAR(still.Get(p.torque), p.m * p.g * p.l * std::sin(0.5), 1e-9);
  EXPECT_EQ(still.Get(p.angle), 0.5);
}

TEST(FindEquilibrium, FindsWhereThePendulumHangs) {
  HangingPendulum x;
  const Pendulum& p = x.pendulum;
  Context start = x.diagram.MakeContext();
  start.Set(p.torque, 3.0);
  start.Set(p.speed, 0.4);
  Context still = FindEquilibrium(x.diagram, start, {p.angle, p.speed});
  EXPECT_NEAR(still.Get(p.angle), std::asin(3.0 / (p.m * p.g * p.l)), 1e-9);
  EXPECT_NEAR(still.Get(p.speed), 0, 1e-9);
}

TEST(FindEquilibrium, StaysWhereItIsWhenThatIsOne) {
  HangingPendulum x;
  const Context start = x.diagram.MakeContext();
  EXPECT_TRUE(FindEquilibrium(x.diagram, start, {x.pendulum.torque}) == start);
}

TEST(FindEquilibrium, NamesTheStateThatMovesWhereThereIsNone) {
  HangingPendulum x;
  Context start = x.diagram.MakeContext();
  start.Set(x.pendulum.speed, 2.0);
  EXPECT_EQ(ErrorOf([&] { FindEquilibrium(x.diagram, start, {x.pendulum.torque}); }),
            "found no equilibrium in 100 steps: the rate of pendulum.angle is 2, tolerance 1e-09\n"
            "let more values be free, or start nearer to one");
}

TEST(FindEquilibrium, RefusesWhatItCannotChange) {
  HangingPendulum x;
  const Context start = x.diagram.MakeContext();
  EXPECT_EQ(ErrorOf([&] { FindEquilibrium(x.diagram, start, {x.pendulum.height}); }),
            "pendulum.height cannot be free: name unconnected inputs and Continuous values");
  EXPECT_EQ(ErrorOf([&] { FindEquilibrium(x.diagram, start, {}, {.tolerance = 0}); }),
            "tolerance must be > 0, got 0");
}

/// ∫ (xᵀ Q x + u² R) dt, beside what it is fed with.
class Cost final : public Block {
 public:
  explicit Cost(const Names& states)
      : state{this, "state", states}, torque{this, "torque"}, spent{this, "spent"} {
    Derivative(spent).From(state, torque).As([](const NumberVector& x, double tau) {
      const double off = x(0) - std::numbers::pi;
      return q * off * off + x(1) * x(1) + r * tau * tau;
    });
  }

  Input<NumberVector> state;
  Input<double> torque;
  Continuous<double> spent;

  static constexpr double q = 10, r = 0.1;
};

TEST(Linearize, GivesTheFeedbackOfLeastCostThatHoldsAPendulumUpright) {
  constexpr double kPi = std::numbers::pi;
  Lqr lqr;
  {
    DiagramBuilder b;
    auto& pendulum = b.Add<Pendulum>("pendulum");
    const Diagram diagram = b.Build();
    Context upright = diagram.MakeContext();
    upright.Set(pendulum.angle, kPi);
    const Linearization l = Linearize(diagram, upright, {.inputs = {pendulum.torque}});
    lqr = ContinuousLqr(l.A, l.B,
                        {.Q = Eigen::Vector2d(Cost::q, 1).asDiagonal().toDenseMatrix(),
                         .R = Eigen::MatrixXd::Constant(1, 1, Cost::r)},
                        l.states);
  }
  DiagramBuilder b;
  const Names states{"angle", "speed"};
  auto& pendulum = b.Add<Pendulum>("pendulum");
  auto& state = b.Add<Multiplexer>("state", {.names = states});
  auto& feedback = b.Add<StateFeedback<double>>(
      "feedback", {.states = states, .gain = lqr.K, .rest = Eigen::Vector2d(kPi, 0)});
  auto& cost = b.Add<Cost>("cost", states);
  b.Connect(pendulum.angle, state.u);
  b.Connect(pendulum.speed, state.u);
  b.Connect(state.y, feedback.x);
  b.Connect(feedback.u, pendulum.torque);
  b.Connect(state.y, cost.state);
  b.Connect(feedback.u, cost.torque);
  const Diagram diagram = b.Build();

  Simulator sim(diagram,
                {.integrator = {.relative_tolerance = 1e-10, .absolute_tolerance = 1e-12}});
  const double slowest = -lqr.modes.real().maxCoeff();
  ASSERT_GT(slowest, 0);
  constexpr double kOff = 0.01;  // [rad]
  sim.Set(pendulum.angle, kPi + kOff);
  sim.AdvanceTo(20 / slowest);
  // What is left has fallen by exp(−20) to 2e-11; some hundred steps err by 3e-10 each.
  EXPECT_NEAR(sim.Get(pendulum.angle), kPi, 1e-7);
  // The cost is x₀ᵀ S x₀, but for sin x − x = x³/6: a part of the order of x₀²/6.
  EXPECT_NEAR(sim.Get(cost.spent) / (kOff * kOff * lqr.S(0, 0)), 1, kOff * kOff);
}

}  // namespace
}  // namespace pliant
