// solve_qp, QpSolution, lqr, dlqr.

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <limits>
#include <memory>

#include "pliant/controllers/lqr.h"
#include "pliant/controllers/qp_solver.h"
#include "pliant/python/array.h"
#include "pliant/python/bind.h"
#include "pliant/systems/error.h"

namespace pliant::python {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::VectorXd LimitOf(const py::object& limit, const std::string& name, Eigen::Index n,
                        double without) {
  return limit.is_none() ? Eigen::VectorXd::Constant(n, without)
                         : VectorOf(limit, name, n, May::BeInfinite);
}

const char* WordOf(QpStatus status) {
  switch (status) {
    case QpStatus::Solved:
      return "solved";
    case QpStatus::Infeasible:
      return "infeasible";
    case QpStatus::NotConvex:
      return "not_convex";
    case QpStatus::IterationLimit:
      return "iteration_limit";
    case QpStatus::InvalidData:
      break;
  }
  return "invalid_data";
}

QpSolution SolveQp(const py::object& H, const py::object& g, const py::object& A,
                   const py::object& lower, const py::object& upper, const py::object& x_lower,
                   const py::object& x_upper, int max_iterations) {
  const Eigen::VectorXd gradient = VectorOf(g, "g");
  const Eigen::Index n = gradient.size();
  Require(n >= 1 && n <= kMaxQpVariables, "g: expected 1 to " + Text(kMaxQpVariables) + " numbers",
          n);
  Require(!A.is_none() || (lower.is_none() && upper.is_none()),
          "lower and upper are of the rows of A, and there is no A; for x give x_lower, x_upper");
  const Eigen::MatrixXd rows = A.is_none() ? Eigen::MatrixXd(0, n) : MatrixOf(A, "A", kAny, n);
  Require(rows.rows() <= kMaxQpRows, "A: expected at most " + Text(kMaxQpRows) + " rows",
          rows.rows());
  QpProblem problem(static_cast<int>(n), static_cast<int>(rows.rows()));
  problem.H = MatrixOf(H, "H", n, n);
  const double off = (problem.H - problem.H.transpose()).cwiseAbs().maxCoeff();
  Require(off <= 1e-12 * problem.H.cwiseAbs().maxCoeff(),
          "H must be symmetric; its largest difference from the transpose", off);
  problem.g = gradient;
  problem.A = rows;
  problem.lower = LimitOf(lower, "lower", rows.rows(), -kInfinity);
  problem.upper = LimitOf(upper, "upper", rows.rows(), kInfinity);
  problem.x_lower = LimitOf(x_lower, "x_lower", n, -kInfinity);
  problem.x_upper = LimitOf(x_upper, "x_upper", n, kInfinity);
  const auto workspace = std::make_unique<QpWorkspace>();
  QpLimits active;
  QpSolution solution;
  Solve(problem, *workspace, active, solution, {.max_iterations = max_iterations});
  return solution;
}

template <Lqr (*kDesign)(const Eigen::MatrixXd&, const Eigen::MatrixXd&, const QuadraticCost&,
                         const std::vector<std::string>&)>
Lqr Design(const py::object& A, const py::object& B, const py::object& Q, const py::object& R,
           const std::vector<std::string>& names) {
  const Eigen::MatrixXd a = MatrixOf(A, "A");
  const Eigen::Index n = a.rows();
  Require(a.cols() == n, "A: expected as many columns as rows, " + Text(n), a.cols());
  const Eigen::MatrixXd b = MatrixOf(B, "B", n, kAny);
  Require(names.empty() || static_cast<Eigen::Index>(names.size()) == n,
          "names: expected one for each of the " + Text(n) + " states", names.size());
  return kDesign(a, b, {.Q = MatrixOf(Q, "Q", n, n), .R = MatrixOf(R, "R", b.cols(), b.cols())},
                 names);
}

}  // namespace

void BindControl(py::module_& m) {
  py::class_<QpSolution>(m, "QpSolution", R"(Where the QP solver ended. The multipliers satisfy

  H x + g = Aᵀ λ + μ,   λ ≥ 0 at a lower limit, ≤ 0 at an upper one, 0 elsewhere

Of an infeasible problem they prove it: Aᵀ λ + μ = 0, while the limits ask for more.)")
      .def_property_readonly(
          "status", [](const QpSolution& s) { return std::string(WordOf(s.status)); },
          "'solved', 'infeasible', 'not_convex', 'iteration_limit' or 'invalid_data'.")
      .def_property_readonly(
          "x", [](const QpSolution& s) { return VectorArray(s.x); }, "(n,)")
      .def_property_readonly(
          "row_multipliers", [](const QpSolution& s) { return VectorArray(s.row_multipliers); },
          "λ, (m,)")
      .def_property_readonly(
          "bound_multipliers", [](const QpSolution& s) { return VectorArray(s.bound_multipliers); },
          "μ, (n,)")
      .def_readonly("iterations", &QpSolution::iterations, "Limits that entered or left.")
      .def("__bool__", [](const QpSolution& s) { return s.status == QpStatus::Solved; });
  m.def("solve_qp", &SolveQp, "H"_a, "g"_a, "A"_a = py::none(), "lower"_a = py::none(),
        "upper"_a = py::none(), py::kw_only(), "x_lower"_a = py::none(), "x_upper"_a = py::none(),
        "max_iterations"_a = 1000,
        R"(The strictly convex quadratic program of the controllers:

  minimise ½ xᵀ H x + gᵀ x   subject to   lower ≤ A x ≤ upper,   x_lower ≤ x ≤ x_upper

H (n, n), g (n,), A (m, n); limits may be infinite, None is none. At most 64 variables, 128 rows.
Goldfarb & Idnani's dual active-set method; equal arguments give equal bits.)");

  py::class_<Lqr>(m, "Lqr", "The state feedback u = −K x of least quadratic cost xᵀ S x.")
      .def_property_readonly(
          "K", [](const Lqr& l) { return MatrixArray(l.K); }, "(m, n)")
      .def_property_readonly(
          "S", [](const Lqr& l) { return MatrixArray(l.S); }, "(n, n)")
      .def_property_readonly(
          "modes",
          [](const Lqr& l) {
            return py::array_t<std::complex<double>>(l.modes.size(), l.modes.data());
          },
          "Eigenvalues of A − B K, (n,), complex.");
  m.def("lqr", &Design<ContinuousLqr>, "A"_a, "B"_a, "Q"_a, "R"_a,
        "names"_a = std::vector<std::string>(),
        R"(For ẋ = A x + B u and ∫ (xᵀ Q x + uᵀ R u) dt:

  K = R⁻¹ Bᵀ S,   Aᵀ S + S A − S B R⁻¹ Bᵀ S + Q = 0

A (n, n), B (n, m), Q (n, n) ≥ 0, R (m, m) > 0. `names` of the states are for messages.)");
  m.def("dlqr", &Design<DiscreteLqr>, "A"_a, "B"_a, "Q"_a, "R"_a,
        "names"_a = std::vector<std::string>(),
        R"(For x⁺ = A x + B u and Σ (xᵀ Q x + uᵀ R u):

  K = (R + Bᵀ S B)⁻¹ Bᵀ S A,   Aᵀ S A − S − Aᵀ S B K + Q = 0)");
}

}  // namespace pliant::python
