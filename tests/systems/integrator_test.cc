#include "pliant/systems/integrator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
thread_local long allocations = 0;  // those of C and, through malloc, those of operator new
void* malloc(std::size_t n) {
  ++allocations;
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  ++allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
  ++allocations;
  return __libc_realloc(p, n);
}
}
#endif

namespace pliant {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;
using State = std::vector<double>;
using In = std::span<const double>;
using Out = std::span<double>;

constexpr std::array kExplicit{Method::kHeunEuler,    Method::kBogackiShampine, Method::kZonneveld,
                               Method::kSayfyAburub,  Method::kCashKarp,        Method::kFehlberg,
                               Method::kDormandPrince};
constexpr std::array kAll{Method::kHeunEuler,     Method::kBogackiShampine,
                          Method::kZonneveld,     Method::kSayfyAburub,
                          Method::kCashKarp,      Method::kFehlberg,
                          Method::kDormandPrince, Method::kSdirk,
                          Method::kAdams,         Method::kBdf};

int Order(Method method) {
  switch (method) {
    case Method::kHeunEuler:
      return 2;
    case Method::kBogackiShampine:
      return 3;
    case Method::kZonneveld:
    case Method::kSayfyAburub:
      return 4;
    default:
      return 5;
  }
}

constexpr auto kOscillate = [](double, In y, Out rate) {  // y = (cos t, −sin t) from (1, 0)
  rate[0] = y[1];
  rate[1] = -y[0];
  return true;
};

constexpr auto kSwing = [](double t, In y, Out rate) {  // a driven pendulum
  rate[0] = y[1];
  rate[1] = -9.81 * std::sin(y[0]) - 0.1 * y[1] + std::sin(3 * t);
  return true;
};

constexpr auto kDecay = [](double t, In y, Out rate) {  // y = 1/(1 + t²) from 1
  rate[0] = -2 * t * y[0] * y[0];
  return true;
};

State At(const Integrator& integrator, double t, std::size_t states) {
  State y(states);
  integrator.Interpolate(t, y);
  return y;
}

void Reach(Integrator& integrator, double t, double t_stop) {
  while (t < t_stop) t = integrator.Step(t_stop);
}

double ErrorOfDecay(Method method, double h, double interval) {
  const auto integrator =
      MakeIntegrator({.method = method, .fixed_step_s = h}, 1, Derivatives{kDecay});
  integrator->Reset(0, State{1}, 0);
  double t = 0;
  for (int k = 1; t < 1; ++k) {
    const double t_stop = std::min(k * interval, 1.0);
    Reach(*integrator, t, t_stop);
    t = t_stop;
  }
  return std::abs(At(*integrator, 1, 1)[0] - 0.5);
}

TEST(Integrator, EveryExplicitMethodHasTheOrderOfItsTable) {
  for (const Method method : kExplicit) {
    const double observed =
        std::log2(ErrorOfDecay(method, 1.0 / 32, 1) / ErrorOfDecay(method, 1.0 / 64, 1));
    EXPECT_NEAR(observed, Order(method), 0.3) << Name(method);  // next order in h: about h
  }
}

TEST(Integrator, FixedStepsKeepTheirOrderWhenStopTimesCutThemShort) {
  for (const Method method : kExplicit) {
    // 0.1 is no multiple of h: every interval ends with a shorter step.
    const double observed =
        std::log2(ErrorOfDecay(method, 0.03, 0.1) / ErrorOfDecay(method, 0.015, 0.1));
    EXPECT_NEAR(observed, Order(method), 0.6) << Name(method);  // the short steps are not halved
  }
}

TEST(Integrator, FixedStepsResumeAfterAStopTime) {
  const auto integrator = MakeIntegrator({.fixed_step_s = 0.25}, 2, Derivatives{kOscillate});
  integrator->Reset(0, State{1, 0}, 0);
  EXPECT_EQ(integrator->Step(1), 0.25);
  EXPECT_EQ(integrator->Step(0.375), 0.375);
  EXPECT_EQ(integrator->Step(1), 0.625);
  EXPECT_EQ(integrator->next_step(), 0.25);
}

TEST(Integrator, TheErrorFollowsTheTolerance) {
  for (const Method method : kAll) {
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
      const auto integrator = MakeIntegrator(
          {.method = method, .relative_tolerance = tolerance, .absolute_tolerance = tolerance}, 2,
          Derivatives{kOscillate});
      integrator->Reset(0, State{1, 0}, 0);
      Reach(*integrator, 0, 10);
      const State y = At(*integrator, 10, 2);
      // A rotation does not amplify: each step adds at most √2 · 2 tolerance, if its estimate
      // holds.
      const double bound = integrator->statistics().steps * 2 * std::numbers::sqrt2 * tolerance;
      EXPECT_LT(std::hypot(y[0] - std::cos(10), y[1] + std::sin(10)), bound)
          << Name(method) << " at " << tolerance;
    }
  }
}

TEST(Integrator, AnExponentialIsExactToTheTolerance) {
  auto grow = [](double, In y, Out rate) {
    rate[0] = y[0];
    return true;
  };
  const auto integrator = MakeIntegrator(
      {.method = Method::kDormandPrince, .relative_tolerance = 1e-12}, 1, Derivatives{grow});
  integrator->Reset(0, State{1}, 0);
  Reach(*integrator, 0, 1);
  const double bound = integrator->statistics().steps * 1.1e-8;  // absolute_tolerance at each step
  EXPECT_NEAR(At(*integrator, 1, 1)[0], std::numbers::e, std::numbers::e * bound);
}

// Prothero and Robinson: y = cos t for any rate of attraction, here 1e5/s.
constexpr auto kStiff = [](double t, In y, Out rate) {
  rate[0] = -1e5 * (y[0] - std::cos(t)) - std::sin(t);
  return true;
};

TEST(Integrator, StiffProblemsNeedImplicitMethods) {
  for (const Method method : {Method::kSdirk, Method::kBdf}) {
    const auto integrator = MakeIntegrator({.method = method}, 1, Derivatives{kStiff});
    integrator->Reset(0, State{1}, 0);
    Reach(*integrator, 0, 1);
    // A twentieth of what stability leaves to an explicit method, below.
    EXPECT_LT(integrator->statistics().steps, 2000) << Name(method);
    // Errors of a step die out in 10 µs: what remains is that of the last few steps.
    EXPECT_NEAR(At(*integrator, 1, 1)[0], std::cos(1), 1e-5) << Name(method);
  }
  const auto integrator = MakeIntegrator({}, 1, Derivatives{kStiff});
  integrator->Reset(0, State{1}, 0);
  Reach(*integrator, 0, 0.01);
  EXPECT_GT(integrator->statistics().steps, 0.01 * 1e5 / 2.6);  // stable for h λ < 2.51
}

TEST(Integrator, DenseOutputHasTheErrorOfACubic) {
  for (const Method method : {Method::kZonneveld, Method::kDormandPrince}) {
    const auto integrator =
        MakeIntegrator({.method = method, .fixed_step_s = 0.05}, 2, Derivatives{kOscillate});
    integrator->Reset(0, State{1, 0}, 0);
    for (double t = 0; t < 1;) {
      const double begin = t;
      t = integrator->Step(1);
      for (const double s : {0.1, 0.5, 0.9}) {
        const double inside = begin + s * (t - begin);
        // h⁴/384 max|y⁗| of the cubic, and the error of the solution: (10 h)⁵ in 1e-5 is ample.
        EXPECT_NEAR(At(*integrator, inside, 2)[0], std::cos(inside), std::pow(0.05, 4) / 384 + 1e-7)
            << Name(method);
      }
    }
  }
}

TEST(Integrator, DenseOutputIsAsGoodAsTheSteps) {
  for (const Method method : kAll) {
    const auto integrator =
        MakeIntegrator({.method = method, .relative_tolerance = 1e-8, .max_step_s = 0.05}, 2,
                       Derivatives{kOscillate});
    integrator->Reset(0, State{1, 0}, 0);
    for (double t = 0; t < 3;) {
      const double begin = t;
      t = integrator->Step(3);
      const double inside = (begin + t) / 2;
      const double bound = integrator->statistics().steps * 2 * std::numbers::sqrt2 * 2e-8;
      EXPECT_NEAR(At(*integrator, inside, 2)[0], std::cos(inside),
                  bound + std::pow(t - begin, 4) / 384)
          << Name(method) << " at " << inside;
    }
  }
}

TEST(Integrator, DenseOutputIsExactAtBothEnds) {
  for (const Method method : kAll) {
    const auto integrator = MakeIntegrator({.method = method}, 2, Derivatives{kSwing});
    State end{0.3, -0.2};
    integrator->Reset(0.1, end, 0);
    EXPECT_EQ(At(*integrator, 0.1, 2), end);
    for (double t = 0.1; t < 0.7;) {
      const double begin = t;
      t = integrator->Step(0.7);
      EXPECT_EQ(At(*integrator, begin, 2), end) << Name(method);
      end = At(*integrator, t, 2);
      EXPECT_NE(At(*integrator, (begin + t) / 2, 2), end) << Name(method);
    }
    EXPECT_THROW(At(*integrator, 0.1, 2), Error);
  }
}

TEST(Integrator, StopTimesAreReachedExactly) {
  for (const Method method : kAll) {
    const auto integrator = MakeIntegrator({.method = method}, 2, Derivatives{kSwing});
    double t = 1000.0 / 3;
    integrator->Reset(t, State{0.3, 0}, 0);
    for (int k = 1; k <= 50; ++k) {
      const double t_stop = 1000.0 / 3 + k / 30.0;
      while (t < t_stop) {
        t = integrator->Step(t_stop);
        ASSERT_LE(t, t_stop) << Name(method);
      }
      ASSERT_EQ(t, t_stop) << Name(method);
    }
  }
}

TEST(Integrator, TimesWithinRoundOffAreOneTime) {
  const auto integrator = MakeIntegrator({}, 2, Derivatives{kSwing});
  const State y{0.3, 0};
  integrator->Reset(1000, y, 0);
  const double next = std::nextafter(1000, 2000);
  EXPECT_EQ(integrator->Step(1000), 1000);
  EXPECT_EQ(integrator->Step(next), next);
  EXPECT_EQ(At(*integrator, next, 2), y);
  EXPECT_EQ(integrator->statistics().derivative_calls, 0);
}

/// A sampled run: 40 ticks of 1 kHz, the input held in between. All states, times and steps.
State Sampled(Integrator& integrator, double& input, double h) {
  State trace, y{0.3, -0.2};
  for (int k = 0; k < 40; ++k) {
    input = k % 7;
    double t = k * 1e-3;
    integrator.Reset(t, y, h);
    while (t < (k + 1) * 1e-3) {
      const double begin = t;
      t = integrator.Step((k + 1) * 1e-3);
      integrator.Interpolate(begin + 0.3 * (t - begin), y);
      trace.insert(trace.end(), {t, y[0], y[1]});
    }
    integrator.Interpolate(t, y);
    h = integrator.next_step();
    trace.insert(trace.end(), {h, y[0], y[1]});
  }
  return trace;
}

TEST(Integrator, AUsedIntegratorAndANewOneGiveTheSameNumbers) {
  for (const Method method : kAll) {
    for (const double h : {0.0, 2e-4, 0.05}) {
      double input = 0;
      bool refuse = false;
      auto f = [&](double t, In y, Out rate) {
        kSwing(t, y, rate);
        rate[1] += 50 * input - 30 * y[1];
        return !refuse;
      };
      const IntegratorOptions options{.method = method};
      const State fresh = Sampled(*MakeIntegrator(options, 2, Derivatives{f}), input, h);

      const auto used = MakeIntegrator(options, 2, Derivatives{f});
      used->Reset(-5, State{3, 1}, 0.01);
      for (double t = -5; t < 2;) t = used->Step(2);
      EXPECT_EQ(Sampled(*used, input, h), fresh) << Name(method) << ", h = " << h;

      used->Reset(1, State{2, 40}, 0);  // leave it in the middle of nowhere
      used->Step(8);
      EXPECT_EQ(Sampled(*used, input, h), fresh) << Name(method) << ", h = " << h;

      used->Reset(1, State{2, 40}, 0);
      refuse = true;
      EXPECT_THROW(used->Step(8), IntegratorFailure);
      refuse = false;
      EXPECT_EQ(Sampled(*used, input, h), fresh) << Name(method) << ", h = " << h;
    }
  }
}

TEST(Integrator, ASampledRunThatCarriesItsStepOverTakesOneStepPerTick) {
  const auto integrator = MakeIntegrator({}, 2, Derivatives{kOscillate});
  State y{1, 0};
  double h = 0;
  for (int k = 0; k < 1000; ++k) {
    integrator->Reset(k * 1e-3, y, h);
    Reach(*integrator, k * 1e-3, (k + 1) * 1e-3);
    integrator->Interpolate((k + 1) * 1e-3, y);
    h = integrator->next_step();
  }
  // The first tick starts from a small estimated step; from then on four stages, none wasted.
  EXPECT_NEAR(integrator->statistics().steps, 1000, 10);
  EXPECT_NEAR(integrator->statistics().derivative_calls, 4000, 40);
  EXPECT_EQ(integrator->statistics().rejected_steps, 0);
}

TEST(Integrator, CountsItsStepsAndKnowsTheirSizes) {
  const auto integrator = MakeIntegrator({.fixed_step_s = 0.25}, 2, Derivatives{kOscillate});
  EXPECT_EQ(integrator->statistics().text(), "no step");
  EXPECT_EQ(integrator->statistics().mean_step(), 0);
  integrator->Reset(0, State{1, 0}, 0);
  Reach(*integrator, 0, 1.125);
  const Integrator::Statistics s = integrator->statistics();
  EXPECT_EQ(s.steps, 5);
  EXPECT_EQ(s.shortest_step, 0.125);  // cut by the stop time
  EXPECT_EQ(s.longest_step, 0.25);
  EXPECT_EQ(s.integrated, 1.125);
  EXPECT_EQ(s.mean_step(), 0.225);
  EXPECT_EQ(s.text(), "5 steps of 125 ms to 250 ms, 225 ms on average, 0 rejected; " +
                          Text(s.derivative_calls) + " derivative calls");
}

TEST(Integrator, AShortLastStepDoesNotShortenTheNextOne) {
  for (const double rest : {1e-3, 1e-9, 1e-13}) {  // the last below min_step_s
    const auto integrator = MakeIntegrator({}, 2, Derivatives{kOscillate});
    integrator->Reset(0, State{1, 0}, 0);
    double t = 0;
    for (int k = 0; k < 20; ++k) t = integrator->Step(1);
    const double h = integrator->next_step();
    EXPECT_EQ(integrator->Step(t + rest), t + rest);
    EXPECT_GE(integrator->next_step(), h);
  }
}

TEST(Integrator, StopTimesMayLieCloserThanTheSmallestStep) {
  for (const Method method : kAll) {
    const auto integrator = MakeIntegrator({.method = method}, 2, Derivatives{kSwing});
    integrator->Reset(1, State{0.3, 0}, 0);
    EXPECT_EQ(integrator->Step(1 + 1e-13), 1 + 1e-13) << Name(method);
    Reach(*integrator, 1 + 1e-13, 1.01);
    EXPECT_EQ(integrator->Step(1.01 + 1e-13), 1.01 + 1e-13) << Name(method);
    Reach(*integrator, 1.01 + 1e-13, 1.02);
  }
}

#ifdef COUNTS_ALLOCATIONS  // a sanitizer has its own malloc
TEST(Integrator, NothingIsAllocatedWhileRunning) {
  std::vector<IntegratorOptions> quiet{{.method = Method::kAdams}};
  for (const Method method : kExplicit) {
    quiet.push_back({.method = method});
    quiet.push_back({.method = method, .fixed_step_s = 3e-4});
  }
  for (const IntegratorOptions& options : quiet) {
    const auto integrator = MakeIntegrator(options, 2, Derivatives{kSwing});
    std::array y{0.3, 0.0};
    double h = 0;
    const long before = allocations;
    for (int k = 0; k < 100; ++k) {
      double t = k * 1e-3;
      integrator->Reset(t, y, h);
      while (t < (k + 1) * 1e-3) t = integrator->Step((k + 1) * 1e-3);
      integrator->Interpolate(t, y);
      h = integrator->next_step();
    }
    integrator->Step(0.5);
    integrator->Interpolate(0.1001, y);
    EXPECT_EQ(allocations, before) << Name(options.method);
  }
  const long before = allocations;
  double* volatile seen = new double;
  delete seen;
  EXPECT_EQ(allocations, before + 1) << "the count does not work";
}
#endif

std::string MessageOf(const IntegratorOptions& options, int states = 1) {
  try {
    MakeIntegrator(options, states, Derivatives{kDecay});
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Integrator, OptionsAreCheckedWithBoundAndValue) {
  EXPECT_EQ(MessageOf({.relative_tolerance = 1e-16}),
            "relative_tolerance must be from 1e-14 to below 1, got 1e-16");
  EXPECT_EQ(MessageOf({.absolute_tolerance = 0}), "absolute_tolerance must be > 0, got 0");
  EXPECT_EQ(MessageOf({.max_step_s = -1}), "max_step_s must be > 0 s, got -1");
  EXPECT_EQ(MessageOf({.min_step_s = 0}), "min_step_s must be > 0 s, got 0");
  EXPECT_EQ(MessageOf({.max_step_s = 0.1, .min_step_s = 0.5}),
            "min_step_s must be at most max_step_s = 0.1, got 0.5");
  EXPECT_EQ(MessageOf({.initial_step_s = -1}), "initial_step_s must be >= 0 s, got -1");
  EXPECT_EQ(MessageOf({.fixed_step_s = -1}), "fixed_step_s must be >= 0 s, got -1");
  EXPECT_EQ(MessageOf({.method = Method::kAdams, .fixed_step_s = 1e-3}),
            "fixed_step_s needs an explicit Runge–Kutta method, got adams");
  EXPECT_EQ(MessageOf({.max_steps_between_events = 0}),
            "max_steps_between_events must be from 1 to 1000000000, got 0");
  EXPECT_EQ(MessageOf({}, 0), "an integrator needs at least 1 state, got 0");
  EXPECT_EQ(MessageOf({.relative_tolerance = std::numeric_limits<double>::quiet_NaN()}),
            "relative_tolerance must be from 1e-14 to below 1, got nan");
}

TEST(Integrator, MisuseIsRefused) {
  EXPECT_THROW(MakeIntegrator({}, 1, Derivatives{nullptr, nullptr}), Error);
  const auto integrator = MakeIntegrator({}, 2, Derivatives{kOscillate});
  EXPECT_THROW(integrator->Step(1), Error);
  EXPECT_THROW(integrator->Reset(0, State{1}, 0), Error);
  EXPECT_THROW(integrator->Reset(0, State{1, 0}, -1), Error);
  integrator->Reset(0, State{1, 0}, 0);
  EXPECT_THROW(integrator->Step(-1), Error);
}

IntegratorFailure FailureOf(const IntegratorOptions& options, Derivatives f, const State& y,
                            double t_stop) {
  const auto integrator = MakeIntegrator(options, static_cast<int>(y.size()), f);
  integrator->Reset(0, y, 0);
  try {
    Reach(*integrator, 0, t_stop);
  } catch (const IntegratorFailure& failure) {
    EXPECT_THROW(integrator->Step(t_stop), Error) << "a failed integrator needs a Reset";
    return failure;
  }
  ADD_FAILURE() << Name(options.method) << " does not fail";
  return {0, -1, ""};
}

TEST(Integrator, ANanDerivativeIsReportedWithItsTimeAndElement) {
  auto f = [](double t, In, Out rate) {
    rate[0] = 1;
    rate[1] = t < 0.5 ? 1 : std::numeric_limits<double>::quiet_NaN();
    rate[2] = rate[1];
    return true;
  };
  for (const Method method : kAll) {
    const auto failure = FailureOf({.method = method}, Derivatives{f}, {0, 0, 0}, 1);
    EXPECT_EQ(failure.element(), 1) << Name(method);
    EXPECT_GE(failure.time(), 0.5) << Name(method);
    EXPECT_LE(failure.time(), 0.6) << Name(method);  // max_step_s
    EXPECT_THAT(failure.what(), HasSubstr("a derivative is nan (state element 1)"));
  }
}

TEST(Integrator, ADerivativeThatCannotBeEvaluatedIsReported) {
  auto f = [](double, In, Out) { return false; };
  for (const Method method : kAll)
    EXPECT_THAT(FailureOf({.method = method}, Derivatives{f}, {0}, 1).what(),
                StrEq("cannot integrate past t = 0 s: the derivatives cannot be evaluated"));
}

TEST(Integrator, AnExceptionOfTheDerivativesComesOutOfStep) {
  auto f = [](double t, In, Out rate) {
    if (t > 0.5) throw std::domain_error("half past");
    rate[0] = 1;
    return true;
  };
  for (const Method method : kAll) {
    const auto integrator = MakeIntegrator({.method = method}, 1, Derivatives{f});
    integrator->Reset(0, State{0}, 0);
    EXPECT_THROW(Reach(*integrator, 0, 1), std::domain_error) << Name(method);
    integrator->Reset(0, State{0}, 0);
    Reach(*integrator, 0, 0.25);
    EXPECT_NEAR(At(*integrator, 0.25, 1)[0], 0.25, 1e-12) << Name(method);  // ẏ = 1: round-off
  }
}

TEST(Integrator, TheElementThatBlowsUpIsNamedWhenStepsGetTooSmall) {
  auto f = [](double, In y, Out rate) {  // y₁ = 1/(1 − t)
    rate[0] = 1;
    rate[1] = y[1] * y[1];
    return true;
  };
  for (const Method method : kAll) {
    const auto failure =
        FailureOf({.method = method, .min_step_s = 1e-7}, Derivatives{f}, {0, 1}, 2);
    EXPECT_EQ(failure.element(), 1) << Name(method) << ": " << failure.what();
    EXPECT_NEAR(failure.time(), 1, 1e-3) << Name(method);
    EXPECT_THAT(failure.reason(), HasSubstr("even with min_step_s = 1e-07 s")) << Name(method);
  }
}

TEST(Integrator, TooManyStepsAreReportedWithTheFastestElement) {
  auto f = [](double, In y, Out rate) {
    rate[0] = 1;
    rate[1] = 1;
    rate[2] = -1e6 * y[2];
    return true;
  };
  const auto failure = FailureOf({.max_steps_between_events = 200}, Derivatives{f}, {0, 0, 1}, 1);
  EXPECT_EQ(failure.element(), 2);
  EXPECT_GT(failure.time(), 0);
  EXPECT_EQ(failure.reason(), "max_steps_between_events = 200 does not reach t = 1 s");
}

TEST(Integrator, StepsAreCountedFromEventToEvent) {
  const auto integrator = MakeIntegrator({.fixed_step_s = 0.01, .max_steps_between_events = 20}, 2,
                                         Derivatives{kOscillate});
  integrator->Reset(0, State{1, 0}, 0);
  for (int k = 0; k < 10; ++k) Reach(*integrator, 0.1 * k, 0.1 * (k + 1));
  EXPECT_EQ(integrator->statistics().steps, 100);
}

TEST(Integrator, TwoIntegratorsRunInTwoThreads) {
  for (const Method method : kAll) {
    const auto run = [method](State& trace) {
      double input = 0;
      auto f = [&](double t, In y, Out rate) {
        kSwing(t, y, rate);
        rate[1] += input;
        return true;
      };
      const auto integrator = MakeIntegrator({.method = method}, 2, Derivatives{f});
      for (int i = 0; i < 20; ++i) trace = Sampled(*integrator, input, 0);
    };
    State alone, first, second;
    run(alone);
    std::thread other{run, std::ref(first)};
    run(second);
    other.join();
    EXPECT_EQ(first, alone) << Name(method);
    EXPECT_EQ(second, alone) << Name(method);
  }
}

}  // namespace
}  // namespace pliant
