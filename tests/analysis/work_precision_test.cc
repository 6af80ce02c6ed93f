#include "pliant/analysis/work_precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/systems/block.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

/// ẍ = −ω² x, x(0) = 1, ẋ(0) = 0; with a wall, no derivative once cos(ω t) is below it.
class Oscillator final : public Block {
 public:
  struct Options {
    double rate;  ///< ω [rad/s]
    double wall = -2;
  };
  explicit Oscillator(const Options& o)
      : position{this, "position"},
        x_{this, "x", {}, 1.0},
        v_{this, "v"},
        rate_{o.rate},
        wall_{o.wall} {
    Derivative(x_).From(v_).As([](double v) { return v; });
    Derivative(v_).From(x_).As(&Oscillator::Accelerate);
    Compute(position).From(x_).As([](double x) { return x; });
  }
  Output<double> position;

 private:
  double Accelerate(double x) const {
    return x < wall_ ? std::numeric_limits<double>::quiet_NaN() : -rate_ * rate_ * x;
  }
  Continuous<double> x_, v_;
  const double rate_, wall_;
};

constexpr double kRate = 3, kDuration = 4;

Observed MakeOscillator(double scale = 1, double wall = -2) {
  DiagramBuilder b;
  auto& arm = b.Add<Oscillator>("arm", {.rate = kRate, .wall = wall});
  return {
      .diagram = b.Build(),
      .look =
          [&arm](Simulator& sim) { return Eigen::VectorXd::Constant(1, sim.Get(arm.position)); },
      .scale = Eigen::VectorXd::Constant(1, scale)};
}

WorkPrecisionOptions Options(std::vector<Method> methods, std::vector<double> tolerances) {
  return {.make = [] { return MakeOscillator(); },
          .duration_s = kDuration,
          .methods = std::move(methods),
          .relative_tolerances = std::move(tolerances),
          .repetitions = 1};
}

double Calls(const WorkPrecisionPoint& p) { return static_cast<double>(p.work.derivative_calls); }

// An error at the end is at most about the sum of the local ones: as many as there are steps, each
// within the tolerance, and no more than some thousand here.
TEST(WorkPrecision, EveryMethodIsAsPreciseAsItsToleranceSays) {
  const std::vector<Method> all{Method::kHeunEuler,     Method::kBogackiShampine,
                                Method::kZonneveld,     Method::kSayfyAburub,
                                Method::kCashKarp,      Method::kFehlberg,
                                Method::kDormandPrince, Method::kSdirk,
                                Method::kAdams,         Method::kBdf};
  const std::vector<WorkPrecisionPoint> points = WorkPrecision(Options(all, {1e-4, 1e-7}));
  ASSERT_EQ(points.size(), 2 * all.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const WorkPrecisionPoint& p = points[i];
    EXPECT_EQ(p.method, all[i / 2]);
    EXPECT_EQ(p.failure, "");
    EXPECT_GT(p.error, 0);
    EXPECT_LT(p.error, 1000 * p.relative_tolerance) << Name(p.method);
    EXPECT_GT(p.work.derivative_calls, p.work.steps) << Name(p.method);
    EXPECT_GE(p.cpu_s, 0);
  }
}

// A formula of order p that estimates the error at order q steps as h ~ tol^(1/(q+1)); its global
// error is h^p, and its cost 1/h: error ~ calls^−p.
TEST(WorkPrecision, ErrorsFallWithWorkAtTheOrderOfTheMethod) {
  struct Case {
    Method method;
    double order;
  };
  for (const Case c : {Case{Method::kHeunEuler, 2}, Case{Method::kBogackiShampine, 3},
                       Case{Method::kDormandPrince, 5}}) {
    const auto points = WorkPrecision(Options({c.method}, {1e-5, 1e-8}));
    const double order =
        std::log(points[0].error / points[1].error) / std::log(Calls(points[1]) / Calls(points[0]));
    EXPECT_NEAR(order, c.order, 0.25 * c.order) << Name(c.method);  // constants vary along x(t)
  }
}

TEST(WorkPrecision, MeasuresTheErrorOfTheClosedForm) {
  const std::vector<WorkPrecisionPoint> points =
      WorkPrecision(Options({Method::kBogackiShampine}, {1e-5}));
  const Observed observed = MakeOscillator();
  Simulator sim(observed.diagram,
                {.integrator = {.relative_tolerance = 1e-5, .absolute_tolerance = 1e-7}});
  double largest = 0;
  for (int k = 1; k <= 400; ++k) {
    sim.AdvanceTo(0.01 * k);
    largest = std::max(largest, std::abs(observed.look(sim)(0) - std::cos(kRate * 0.01 * k)));
  }
  EXPECT_NEAR(points[0].error, largest, 1e-9);  // of the reference
}

TEST(WorkPrecision, TakesErrorsRelativeToTheScale) {
  WorkPrecisionOptions options = Options({Method::kBogackiShampine}, {1e-5});
  const double error = WorkPrecision(options)[0].error;
  options.make = [] { return MakeOscillator(100); };
  EXPECT_DOUBLE_EQ(WorkPrecision(options)[0].error, error / 100);
}

TEST(WorkPrecision, IsTheSameAtEachCallButForTimes) {
  const auto a = WorkPrecision(Options({Method::kAdams, Method::kSdirk}, {1e-5}));
  const auto b = WorkPrecision(Options({Method::kAdams, Method::kSdirk}, {1e-5}));
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].error, b[i].error);
    EXPECT_EQ(a[i].work, b[i].work);
  }
}

// x = cos 3t meets a wall at −0.5 on its way to −1. First every run does, then all but the
// reference.
TEST(WorkPrecision, ReportsWhyARunEnded) {
  WorkPrecisionOptions options = Options({Method::kBogackiShampine}, {1e-5});
  options.make = [] { return MakeOscillator(1, -0.5); };
  EXPECT_NE(ErrorOf([&] { WorkPrecision(options); }).find("the reference run: cannot integrate"),
            std::string::npos);

  int runs = 0;
  options.make = [&runs] { return MakeOscillator(1, runs++ == 0 ? -2 : -0.5); };
  const std::vector<WorkPrecisionPoint> points = WorkPrecision(options);
  EXPECT_NE(points[0].failure.find("a derivative is nan"), std::string::npos) << points[0].failure;
  EXPECT_FALSE(std::isfinite(points[0].error));
}

TEST(WorkPrecision, RefusesWhatItCannotRun) {
  WorkPrecisionOptions options = Options({Method::kAdams}, {1e-5});
  options.duration_s = 0;
  EXPECT_EQ(ErrorOf([&] { WorkPrecision(options); }),
            "duration_s must be at least spacing_s, got 0");
  options.spacing_s = 0;
  EXPECT_EQ(ErrorOf([&] { WorkPrecision(options); }), "spacing_s must be > 0, got 0");
}

TEST(WorkFor, IsTheLeastThatKeepsTheError) {
  const auto point = [](double error, std::int64_t calls) {
    return WorkPrecisionPoint{.method = Method::kAdams,
                              .relative_tolerance = error,
                              .error = error,
                              .cpu_s = 1,
                              .work = {.derivative_calls = calls}};
  };
  const std::vector<WorkPrecisionPoint> points{point(1e-2, 100), point(1e-4, 1000)};
  EXPECT_EQ(WorkFor(1e-1, Method::kAdams, points, Calls), 100);
  EXPECT_EQ(WorkFor(1e-3, Method::kAdams, points, Calls), 1000);
  EXPECT_TRUE(std::isinf(WorkFor(1e-5, Method::kAdams, points, Calls)));
  EXPECT_TRUE(std::isinf(WorkFor(1e-3, Method::kBdf, points, Calls)));
}

}  // namespace
}  // namespace pliant
