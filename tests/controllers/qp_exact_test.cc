// The QP solver of CGAL, in exact arithmetic, against ours.

#include <CGAL/Gmpzf.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <memory>

#include "pliant/controllers/qp_solver.h"
#include "pliant/tests/controllers/qp_adversaries.h"

namespace pliant {
namespace {

struct Exact {
  bool feasible;
  Eigen::VectorXd x;
};

Exact SolveExactly(const QpProblem& qp) {
  CGAL::Quadratic_program<double> program{CGAL::SMALLER, false, 0, false, 0};
  const int n = qp.variables();
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j)
      program.set_d(i, j, qp.H(i, j));  // CGAL's D is H/2, and asks for 2D
    program.set_c(i, qp.g(i));
    program.set_l(i, std::isfinite(qp.x_lower(i)), qp.x_lower(i));
    program.set_u(i, std::isfinite(qp.x_upper(i)), qp.x_upper(i));
  }
  int row = 0;
  const auto add = [&](int i, CGAL::Comparison_result relation, double bound) {
    for (int j = 0; j < n; ++j) program.set_a(j, row, qp.A(i, j));
    program.set_b(row, bound);
    program.set_r(row, relation);
    ++row;
  };
  for (int i = 0; i < qp.rows(); ++i) {
    if (qp.lower(i) == qp.upper(i)) {
      add(i, CGAL::EQUAL, qp.lower(i));
      continue;
    }
    if (std::isfinite(qp.lower(i))) add(i, CGAL::LARGER, qp.lower(i));
    if (std::isfinite(qp.upper(i))) add(i, CGAL::SMALLER, qp.upper(i));
  }
  CGAL::Quadratic_program_options options;
  options.set_pricing_strategy(CGAL::QP_BLAND);  // the one of CGAL's rules that cannot cycle
  const CGAL::Quadratic_program_solution<CGAL::Gmpzf> solution =
      CGAL::solve_quadratic_program(program, CGAL::Gmpzf(), options);
  Exact exact{.feasible = !solution.is_infeasible(), .x = Eigen::VectorXd::Zero(n)};
  if (exact.feasible) {
    int i = 0;
    for (auto value = solution.variable_values_begin(); value != solution.variable_values_end();
         ++value)
      exact.x(i++) = CGAL::to_double(*value);
  }
  return exact;
}

// Problems whose data are small integers: what is degenerate is so exactly, and the exact solver's
// numbers stay short. `BarelyInfeasible` is off by 2⁻²⁰, which is exact too.
class ExactQp : public testing::TestWithParam<int> {};

TEST_P(ExactQp, AgreesInVerdictAndSolution) {
  const auto workspace = std::make_unique<QpWorkspace>();
  for (unsigned seed = 0; seed < 850; ++seed) {  // × 12 kinds: 10 200 problems
    AdversaryMaker maker{10'000 + seed};
    const int n =
        seed % 5 == 0 ? 5 + static_cast<int>(seed / 5 % 3) : 1 + static_cast<int>(seed % 4);
    const QpProblem qp = maker.Make(static_cast<Adversary>(GetParam()), n, true);
    QpLimits active;
    QpSolution solution;
    const QpStatus status = Solve(qp, *workspace, active, solution);
    const Exact exact = SolveExactly(qp);
    ASSERT_EQ(status, exact.feasible ? QpStatus::Solved : QpStatus::Infeasible) << "seed " << seed;
    if (!exact.feasible) continue;
    // A Cholesky solution is off by n ε κ(H) |x|, times a few; vertices of small integers add 1e-8.
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Eigen::MatrixXd(qp.H),
                                                               Eigen::EigenvaluesOnly);
    const double condition = eigen.eigenvalues()(n - 1) / eigen.eigenvalues()(0);
    const double relative = std::max(1e-8, 4 * n * 2.2e-16 * condition);
    ASSERT_LE((solution.x - exact.x).cwiseAbs().maxCoeff(),
              relative * (1 + exact.x.cwiseAbs().maxCoeff()))
        << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Adversaries, ExactQp, testing::Range(0, kAdversaries),
                         [](const auto& instance) {
                           return std::string{Name(static_cast<Adversary>(instance.param))};
                         });

}  // namespace
}  // namespace pliant
