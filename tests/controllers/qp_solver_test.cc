#include "pliant/controllers/qp_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "pliant/controllers/qp_certificate.h"
#include "pliant/tests/controllers/qp_adversaries.h"
#include "pliant/tests/controllers/qp_reference.h"
#include "pliant/tests/controllers/qp_sequences.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using Kind = QpLimit::Kind;
using Side = QpLimit::Side;

// A limit may be violated by 1e-12 of the numbers it is computed from; with weights of 1e8 in H, x
// is as good as 1e-16 √cond H leaves it.
constexpr double kKktTolerance = 1e-10;

struct Answer {
  QpSolution solution;
  QpLimits active;
};

QpWorkspace& Workspace() {
  static const std::unique_ptr<QpWorkspace> workspace = std::make_unique<QpWorkspace>();
  return *workspace;
}

Answer SolveFrom(const QpLimits& active, const QpProblem& qp, const QpOptions& options = {}) {
  Answer a{.solution = {}, .active = active};
  Solve(qp, Workspace(), a.active, a.solution, options);
  return a;
}
Answer SolveCold(const QpProblem& qp, const QpOptions& options = {}) {
  return SolveFrom({}, qp, options);
}

// Optimal by its KKT residual, or impossible by its Farkas vector.
testing::AssertionResult IsProven(const QpProblem& qp, const QpSolution& s) {
  if (s.status == QpStatus::Solved) {
    const KktResidual r = Kkt(qp, s);
    if (r.max() <= kKktTolerance) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "stationarity " << r.stationarity << ", primal "
                                       << r.primal << ", complementarity " << r.complementarity;
  }
  if (s.status == QpStatus::Infeasible) {
    const FarkasCertificate f = Farkas(qp, s);
    // No x of the size of the data, 1e5 at most here, can exist.
    if (f.Excludes(1e5, qp.variables())) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "residual " << f.residual << ", gap " << f.gap;
  }
  return testing::AssertionFailure() << "status " << static_cast<int>(s.status);
}

template <class Vector>
bool SameBits(const Vector& a, const Vector& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

QpProblem Unit(int n, int rows = 0) { return {n, rows}; }

// ‖x − 1‖² in three variables under x_0 + x_1 + x_2 ≤ 1.5
QpProblem Corner() {
  QpProblem qp{3, 1};
  qp.g.setConstant(-1);
  qp.A.setOnes();
  qp.upper(0) = 1.5;
  return qp;
}

TEST(QpSolver, FindsTheUnconstrainedMinimum) {
  QpProblem qp{2, 0};
  qp.H << 2, 1, 1, 2;
  qp.g << -3, 0;
  const Answer a = SolveCold(qp);
  EXPECT_EQ(a.solution.status, QpStatus::Solved);
  EXPECT_NEAR(a.solution.x(0), 2, 1e-15);  // H⁻¹ = [2 −1; −1 2] / 3, round-off only
  EXPECT_NEAR(a.solution.x(1), -1, 1e-15);
  EXPECT_TRUE(a.active.empty());
}

TEST(QpSolver, ProjectsOnABox) {
  QpProblem qp = Unit(4);
  qp.g << -2, 2, -0.5, 0.5;
  qp.x_lower.setConstant(-1);
  qp.x_upper.setConstant(1);
  const Answer a = SolveCold(qp);
  const Eigen::Vector4d expected{1, -1, 0.5, -0.5};
  EXPECT_EQ(a.solution.x, expected);
  const Eigen::Vector4d multipliers{-1, 1, 0, 0};  // μ = x + g
  EXPECT_EQ(a.solution.bound_multipliers, multipliers);
}

TEST(QpSolver, GivesMultipliersTheSignOfTheirSide) {
  QpProblem qp = Corner();
  Answer a = SolveCold(qp);
  EXPECT_NEAR(a.solution.row_multipliers(0), -0.5, 1e-15);  // x = 1/2: x + g = λ
  EXPECT_EQ(a.active, (QpLimits{{Kind::Row, Side::Upper, 0}}));
  qp.g.setConstant(1);
  qp.upper(0) = kInfinity;
  qp.lower(0) = -1.5;
  a = SolveCold(qp);
  EXPECT_NEAR(a.solution.row_multipliers(0), 0.5, 1e-15);
  EXPECT_EQ(a.active, (QpLimits{{Kind::Row, Side::Lower, 0}}));
}

TEST(QpSolver, ReadsTheLowerTriangleOfHOnly) {
  QpProblem qp{2, 0};
  qp.H << 2, kNaN, 1, 2;
  qp.g << -3, 0;
  EXPECT_NEAR(SolveCold(qp).solution.x(0), 2, 1e-15);
}

// --- sequences ---

class ArmSequences : public testing::TestWithParam<std::pair<const char*, ArmQpSequence::Options>> {
 protected:
  static constexpr int kTicks = 10'000;
};

TEST_P(ArmSequences, HaveEveryAnswerProvenWarmAndCold) {
  const ArmQpSequence sequence{GetParam().second};
  QpProblem qp = sequence.MakeProblem();
  QpLimits warm;
  for (int tick = 0; tick < kTicks; ++tick) {
    sequence.Write(tick, qp);
    const Answer a = SolveFrom(warm, qp), b = SolveCold(qp);
    ASSERT_TRUE(IsProven(qp, a.solution)) << "warm, tick " << tick;
    ASSERT_TRUE(IsProven(qp, b.solution)) << "cold, tick " << tick;
    ASSERT_EQ(a.solution.status, b.solution.status) << "tick " << tick;
    if (a.solution.status == QpStatus::Solved) {
      // 1e-16 cond L, with cond M 3e3 and weights 1e4 : 1
      ASSERT_LE(RelativeError(qp, a.active, a.solution), 1e-11) << "warm, tick " << tick;
      ASSERT_LE(RelativeError(qp, b.active, b.solution), 1e-11) << "cold, tick " << tick;
    }
    warm = a.active;
  }
}

INSTANTIATE_TEST_SUITE_P(QpSolver, ArmSequences,
                         testing::Values(std::pair{"Free", kFreeArm},
                                         std::pair{"Limited", kLimitedArm},
                                         std::pair{"Crowded", kCrowdedArm},
                                         std::pair{"Overloaded", kOverloadedArm}),
                         [](const auto& instance) { return instance.param.first; });

TEST(QpSolver, MeetsFullWorkingSetsAndInfeasibleTicksInTheOverloadedSequence) {
  const ArmQpSequence sequence{kOverloadedArm};
  QpProblem qp = sequence.MakeProblem();
  int infeasible = 0, full = 0;
  for (int tick = 0; tick < 10'000; ++tick) {
    sequence.Write(tick, qp);
    const Answer a = SolveCold(qp);
    infeasible += a.solution.status == QpStatus::Infeasible;
    full += a.solution.status == QpStatus::Solved && a.active.size() == qp.variables();
  }
  EXPECT_GT(infeasible, 1500);  // what the tests of this file are worth depends on these
  EXPECT_GT(full, 300);
}

TEST(QpSolver, SolvesWholeBodySequences) {
  for (const BodyQpSequence::Options& size :
       {BodyQpSequence::Options{20, 30, 12}, BodyQpSequence::Options{30, 50, 18},
        BodyQpSequence::Options{50, 80, 24}}) {
    const BodyQpSequence sequence{size};
    QpProblem qp = sequence.MakeProblem();
    QpLimits warm;
    for (int tick = 0; tick < 2000; tick += 10) {
      sequence.Write(tick, qp);
      const Answer a = SolveFrom(warm, qp), b = SolveCold(qp);
      ASSERT_TRUE(IsProven(qp, a.solution)) << size.variables << " variables, tick " << tick;
      ASSERT_TRUE(IsProven(qp, b.solution)) << size.variables << " variables, tick " << tick;
      warm = a.active;
    }
  }
}

// --- degenerate problems ---

class Adversaries : public testing::TestWithParam<int> {};

TEST_P(Adversaries, HaveEveryAnswerProven) {
  for (unsigned seed = 0; seed < 1000; ++seed) {
    AdversaryMaker maker{seed};
    const int n = 1 + static_cast<int>(seed % 16);
    const QpProblem qp = maker.Make(static_cast<Adversary>(GetParam()), n, seed % 3 == 0);
    ASSERT_TRUE(IsProven(qp, SolveCold(qp).solution)) << "seed " << seed;
  }
}

TEST_P(Adversaries, GiveTheSameFromAnyWarmStart) {
  std::mt19937 draw{5};
  for (unsigned seed = 0; seed < 300; ++seed) {
    AdversaryMaker maker{seed};
    const int n = 1 + static_cast<int>(seed % 10);
    const QpProblem qp = maker.Make(static_cast<Adversary>(GetParam()), n, seed % 3 == 0);
    QpLimits garbage;
    for (int i = 0; i < 12; ++i)
      garbage.push_back({.kind = draw() % 2 == 0 ? Kind::Bound : Kind::Row,
                         .side = draw() % 2 == 0 ? Side::Lower : Side::Upper,
                         .index = static_cast<std::int16_t>(static_cast<int>(draw() % 40) - 5)});
    const Answer warm = SolveFrom(garbage, qp), cold = SolveCold(qp);
    ASSERT_TRUE(IsProven(qp, warm.solution)) << "seed " << seed;
    ASSERT_EQ(warm.solution.status, cold.solution.status) << "seed " << seed;
    if (cold.solution.status != QpStatus::Solved) continue;
    const double size = 1 + cold.solution.x.cwiseAbs().maxCoeff();
    // Strictly convex: one solution, to which both come as near as the limits are kept, times cond
    // L.
    ASSERT_LE((warm.solution.x - cold.solution.x).cwiseAbs().maxCoeff(), 1e-7 * size)
        << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(QpSolver, Adversaries, testing::Range(0, kAdversaries),
                         [](const auto& instance) {
                           return std::string{Name(static_cast<Adversary>(instance.param))};
                         });

TEST(QpSolver, KnowsWhichAdversariesAreInfeasible) {
  for (unsigned seed = 0; seed < 200; ++seed)
    for (const auto& [kind, status] :
         {std::pair{Adversary::BarelyInfeasible, QpStatus::Infeasible},
          std::pair{Adversary::InconsistentEqualities, QpStatus::Infeasible},
          std::pair{Adversary::BarelyFeasible, QpStatus::Solved},
          std::pair{Adversary::VertexOfTwentyRows, QpStatus::Solved},
          std::pair{Adversary::DependentEqualities, QpStatus::Solved},
          std::pair{Adversary::PointOfManyEqualities, QpStatus::Solved}}) {
      AdversaryMaker maker{seed};
      const QpProblem qp = maker.Make(kind, 1 + static_cast<int>(seed % 12), false);
      EXPECT_EQ(SolveCold(qp).solution.status, status) << Name(kind) << ", seed " << seed;
    }
}

TEST(QpSolver, SolvesEverySizeUpToTheLargest) {
  for (int n = 1; n <= kMaxQpVariables; ++n) {
    AdversaryMaker maker{static_cast<unsigned>(n)};
    const QpProblem qp = maker.Make(Adversary::Random, n, false);
    EXPECT_TRUE(IsProven(qp, SolveCold(qp).solution)) << "n = " << n;
  }
  QpProblem qp{kMaxQpVariables, kMaxQpRows};
  qp.g.setConstant(-1);
  qp.A.topRows(64).setIdentity();
  qp.A.bottomRows(64).setIdentity();
  qp.upper.setConstant(0.5);
  const Answer a = SolveCold(qp);
  EXPECT_TRUE(IsProven(qp, a.solution));
  EXPECT_EQ(a.active.size(), kMaxQpVariables);
}

// --- infeasible ---

TEST(QpSolver, NamesTheConflictingLimits) {
  QpProblem qp{3, 2};
  qp.A.row(0) << 1, 1, 0;
  qp.A.row(1) << 0, 0, 1;
  qp.lower(0) = 3;
  qp.x_upper << 1, 1, 5;
  const Answer a = SolveCold(qp);
  ASSERT_EQ(a.solution.status, QpStatus::Infeasible);
  EXPECT_THAT(a.solution.conflict,
              testing::UnorderedElementsAre(QpLimit{Kind::Row, Side::Lower, 0},
                                            QpLimit{Kind::Bound, Side::Upper, 0},
                                            QpLimit{Kind::Bound, Side::Upper, 1}));
  const FarkasCertificate f = Farkas(qp, a.solution);
  EXPECT_NEAR(f.residual, 0, 1e-15);  // round-off only
  EXPECT_NEAR(f.gap, 1, 1e-15);       // 3 − 1 − 1
}

TEST(QpSolver, NamesALimitThatIsCrossed) {
  QpProblem qp = Corner();
  qp.lower(0) = 2;
  Answer a = SolveCold(qp);
  EXPECT_EQ(a.solution.status, QpStatus::Infeasible);
  EXPECT_EQ(a.solution.conflict,
            (QpLimits{{Kind::Row, Side::Lower, 0}, {Kind::Row, Side::Upper, 0}}));
  EXPECT_TRUE(IsProven(qp, a.solution));
  qp = Corner();
  qp.x_lower(2) = 1;
  qp.x_upper(2) = 0;
  a = SolveCold(qp);
  EXPECT_EQ(a.solution.status, QpStatus::Infeasible);
  EXPECT_EQ(a.solution.conflict,
            (QpLimits{{Kind::Bound, Side::Lower, 2}, {Kind::Bound, Side::Upper, 2}}));
}

TEST(QpSolver, IsInfeasibleWhereAZeroRowAsksForSomething) {
  QpProblem qp = Unit(2, 1);
  qp.lower(0) = 1;
  const Answer a = SolveCold(qp);
  EXPECT_EQ(a.solution.status, QpStatus::Infeasible);
  EXPECT_EQ(a.solution.conflict, (QpLimits{{Kind::Row, Side::Lower, 0}}));
}

// --- statuses that are not about limits ---

TEST(QpSolver, RefusesAHessianThatIsNotPositiveDefinite) {
  QpProblem qp = Corner();
  qp.H(1, 1) = -1;
  EXPECT_EQ(SolveCold(qp).solution.status, QpStatus::NotConvex);
  qp.H(1, 1) = 0;
  EXPECT_EQ(SolveCold(qp).solution.status, QpStatus::NotConvex);
}

TEST(QpSolver, RefusesATaskWithoutAPosture) {
  const ArmQpSequence sequence{kFreeArm};
  QpProblem qp = sequence.MakeProblem();
  for (int tick = 0; tick < 1000; ++tick) {
    sequence.Write(tick, qp);
    qp.H.diagonal().array() -= 1;  // w₀ = 0: rank 6 of 7, but for round-off
    ASSERT_EQ(SolveCold(qp).solution.status, QpStatus::NotConvex) << "tick " << tick;
  }
}

TEST(QpSolver, ReportsAnIterationLimit) {
  QpProblem qp = Unit(3);
  qp.g.setConstant(-2);
  qp.x_upper.setConstant(1);
  EXPECT_EQ(SolveCold(qp, {.max_iterations = 2}).solution.status, QpStatus::IterationLimit);
  EXPECT_EQ(SolveCold(qp, {.max_iterations = 3}).solution.status, QpStatus::Solved);
  const Answer none = SolveCold(qp, {.max_iterations = 0});
  EXPECT_EQ(none.solution.status, QpStatus::IterationLimit);
  EXPECT_EQ(none.solution.iterations, 0);
}

TEST(QpSolver, ReportsNumbersThatAreNone) {
  const auto status_with = [](const auto& spoil) {
    QpProblem qp = Corner();
    qp.x_lower.setConstant(-3);
    qp.lower(0) = -3;
    spoil(qp);
    return SolveCold(qp).solution.status;
  };
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(status_with([&](QpProblem& qp) { qp.H(0, 0) = bad; }), QpStatus::InvalidData);
    EXPECT_EQ(status_with([&](QpProblem& qp) { qp.H(2, 1) = bad; }), QpStatus::InvalidData);
    EXPECT_EQ(status_with([&](QpProblem& qp) { qp.g(1) = bad; }), QpStatus::InvalidData);
    EXPECT_EQ(status_with([&](QpProblem& qp) { qp.A(0, 2) = bad; }), QpStatus::InvalidData);
  }
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.x_lower(0) = kNaN; }), QpStatus::InvalidData);
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.x_upper(0) = kNaN; }), QpStatus::InvalidData);
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.lower(0) = kNaN; }), QpStatus::InvalidData);
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.upper(0) = kNaN; }), QpStatus::InvalidData);
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.lower(0) = kInfinity; }), QpStatus::InvalidData);
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.x_upper(0) = -kInfinity; }), QpStatus::InvalidData);
  EXPECT_EQ(status_with([](QpProblem& qp) { qp.g.resize(2); }), QpStatus::InvalidData);
}

TEST(QpSolver, LeavesNoNaNInAnAnswer) {
  QpProblem qp = Corner();
  qp.g(1) = kNaN;
  const Answer a = SolveFrom({{Kind::Row, Side::Upper, 0}}, qp);
  EXPECT_EQ(a.solution.x, Eigen::Vector3d::Zero());
  EXPECT_EQ(a.solution.bound_multipliers, Eigen::Vector3d::Zero());
  EXPECT_EQ(a.solution.row_multipliers(0), 0);
  EXPECT_TRUE(a.active.empty());
}

TEST(QpProblem, ChecksItsSizes) {
  const auto message = [](int n, int rows) { return ErrorOf([=] { QpProblem{n, rows}; }); };
  EXPECT_EQ(message(0, 3), "variables of a QP must be from 1 to 64, got 0");
  EXPECT_EQ(message(65, 3), "variables of a QP must be from 1 to 64, got 65");
  EXPECT_EQ(message(7, 129), "rows of a QP must be from 0 to 128, got 129");
  EXPECT_EQ(message(64, 128), "no error");
}

// --- running is quiet ---

TEST(QpSolver, GivesEqualBitsForEqualArguments) {
  const ArmQpSequence sequence{kOverloadedArm};
  QpProblem qp = sequence.MakeProblem();
  QpLimits warm;
  for (int tick = 0; tick < 2000; ++tick) {
    sequence.Write(tick, qp);
    const Answer a = SolveFrom(warm, qp);
    std::memset(static_cast<void*>(&Workspace()), tick % 256, sizeof(QpWorkspace));
    const Answer b = SolveFrom(warm, qp);
    ASSERT_TRUE(SameBits(a.solution.x, b.solution.x)) << "tick " << tick;
    ASSERT_TRUE(SameBits(a.solution.row_multipliers, b.solution.row_multipliers));
    ASSERT_TRUE(SameBits(a.solution.bound_multipliers, b.solution.bound_multipliers));
    ASSERT_EQ(a.active, b.active);
    ASSERT_EQ(a.solution.conflict, b.solution.conflict);
    warm = a.active;
  }
}

TEST(QpSolver, LeavesTheHeapAlone) {
  if (!kCountsAllocations) return;  // a sanitizer has a heap of its own
  const ArmQpSequence arm{kOverloadedArm};
  QpProblem qp = arm.MakeProblem();
  AdversaryMaker maker{3};
  const QpProblem large = maker.Make(Adversary::Random, 50, false);
  const QpProblem degenerate = maker.Make(Adversary::VertexOfTwentyRows, 20, false);
  Workspace();
  QpLimits warm;
  QpSolution solution;
  for (int tick = 0; tick < 1000; ++tick) {
    arm.Write(tick, qp);
    const long before = Allocations();
    Solve(qp, Workspace(), warm, solution);
    for (const QpProblem* other : {&large, &degenerate}) {
      QpLimits none;
      Solve(*other, Workspace(), none, solution);
    }
    ASSERT_EQ(Allocations(), before) << "tick " << tick;
  }
}

TEST(QpLimits, ComparesWhatIsInIt) {
  QpLimits a{{Kind::Row, Side::Lower, 3}, {Kind::Bound, Side::Upper, 1}};
  EXPECT_NE(a, QpLimits{});
  a.clear();
  EXPECT_EQ(a, QpLimits{});
}

}  // namespace
}  // namespace pliant
