#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "pliant/systems/parameter.h"

namespace pliant {

/// How ẏ = f(t, y) is integrated. p(q): a formula of order p with an error estimate of order q.
/// Explicit Runge–Kutta methods restart for nothing, so they suit sampled control, where inputs
/// jump at every tick; multistep methods earn their low cost only over many steps without a
/// restart. Coefficients are those of SUNDIALS 6.4.
enum class Method {
  kHeunEuler,        ///< 2(1): crude and cheap; teaching, coarse sweeps
  kBogackiShampine,  ///< 3(2): sampled control at usual tolerances; what to take when in doubt
  kZonneveld,        ///< 4(3): sampled control, relative tolerance about 1e-8
  kSayfyAburub,      ///< 4(3): a second opinion of order four
  kCashKarp,         ///< 5(4): for derivatives that vary abruptly (Cash & Karp 1990)
  kFehlberg,         ///< 5(4): the classic pair, for comparison with published results
  kDormandPrince,    ///< 5(4): tight tolerances, and smooth plants with few events
  kSdirk,            ///< 4(3) implicit, L-stable: stiff plants with many events
  kAdams,            ///< order 1 to 12: smooth closed loops, derivatives that are costly
  kBdf,              ///< order 1 to 5 implicit: stiff friction and contact without events
};

/// As in scenario files and messages, such as "bogacki_shampine".
const std::vector<std::string>& Words(Method);
inline const char* Name(Method method) { return WordOf(method).c_str(); }

/// A local error e of a step is accepted when
///
///   rms_i( e_i / (relative_tolerance |y_i| + absolute_tolerance) ) ≤ 1
///
struct IntegratorOptions {
  Method method = Method::kBogackiShampine;
  double relative_tolerance = 1e-6;        ///< from 1e-14 to below 1
  double absolute_tolerance = 1e-8;        ///< > 0, in the units of the state
  double max_step_s = 0.1;                 ///< > 0
  double min_step_s = 1e-12;               ///< > 0; only a step cut off by an event may be smaller
  double initial_step_s = 0;               ///< 0: estimated from f, at two or more evaluations
  double fixed_step_s = 0;                 ///< 0: adaptive; otherwise explicit Runge–Kutta only
  int max_steps_between_events = 100'000;  ///< from a Reset or a reached stop time to the next

  template <class F>
  void Parameters(F&& f) {
    f("method", method);
    f("relative_tolerance", relative_tolerance, "",
      Range{.least = 1e-14, .most = 1, .without_most = true});
    f("absolute_tolerance", absolute_tolerance, "", kPositive);
    f("max_step_s", max_step_s, "s", kPositive);
    f("min_step_s", min_step_s, "s", kPositive);
    f("initial_step_s", initial_step_s, "s", kNotNegative);
    f("fixed_step_s", fixed_step_s, "s", kNotNegative);
    f("max_steps_between_events", max_steps_between_events, "", Between(1, 1e9));
  }

  bool operator==(const IntegratorOptions&) const = default;
};

/// A reference to the right-hand side f of ẏ = f(t, y). f writes ẏ to `rate` and returns true, or
/// false when there is no ẏ at (t, y).
class Derivatives {
 public:
  using Function = bool (*)(void* context, double t, std::span<const double> y,
                            std::span<double> rate);

  Derivatives(Function function, void* context) : function_{function}, context_{context} {}

  /// Refers to `f(t, y, rate)`, which must outlive the integrator.
  template <class F>
  requires(std::is_class_v<F> && !std::is_same_v<F, Derivatives>) explicit Derivatives(F& f)
      : function_{[](void* context, double t, std::span<const double> y,
                     std::span<double> rate) -> bool {
          return (*static_cast<F*>(context))(t, y, rate);
        }},
        context_{const_cast<void*>(static_cast<const void*>(&f))} {}

  bool operator()(double t, std::span<const double> y, std::span<double> rate) const {
    return function_(context_, t, y, rate);
  }
  explicit operator bool() const { return function_ != nullptr; }

 private:
  Function function_;
  void* context_;
};

/// The integrator cannot go on. It must be Reset before it is used again.
class IntegratorFailure : public Error {
 public:
  IntegratorFailure(double time, int element, const std::string& reason);

  double time() const { return time_; }  ///< where [s]: of the bad derivative or of the last step
  int element() const { return element_; }  ///< of the state: bad, or worst in error; −1: unknown
  const std::string& reason() const { return reason_; }

 private:
  double time_;
  int element_;
  std::string reason_;
};

/// Solves ẏ = f(t, y) forward in time, step by step.
///
/// What follows Reset(t, y, h) depends on t, y, h and the stop times only, bit for bit: a used
/// integrator and a new one give the same numbers. Explicit Runge–Kutta and Adams methods do not
/// allocate after construction; kBdf and kSdirk allocate a few times in the first Step after a
/// Reset. The exception of an f that throws comes out of Step. One integrator belongs to one thread
/// at a time; different integrators share nothing.
class Integrator {
 public:
  struct Statistics {
    std::int64_t steps = 0;
    std::int64_t rejected_steps = 0;  ///< tried and not accurate enough
    std::int64_t derivative_calls = 0;

    /// Of the steps [s], also of those that a stop time cut short. Infinite and 0: there was none.
    double shortest_step = std::numeric_limits<double>::infinity();
    double longest_step = 0;
    double integrated = 0;  ///< the sum of the steps [s]

    double mean_step() const { return steps > 0 ? integrated / static_cast<double>(steps) : 0; }
    /// Such as "120 steps of 12 µs to 1 ms, 0.8 ms on average, 3 rejected; 480 derivative calls".
    std::string text() const;

    bool operator==(const Statistics&) const = default;
  };

  virtual ~Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Forgets the past and starts at (t, y). Tries a step of h [s] first; h = 0: `initial_step_s`,
  /// or the integrator's own estimate. Call it whenever f or y has jumped. f is not evaluated yet.
  virtual void Reset(double t, std::span<const double> y, double h) = 0;

  /// Takes one step, never past t_stop. Returns the time reached, which is exactly t_stop when the
  /// step ends there. Times closer together than 100 ε |t| are one time. t_stop may be another one
  /// at each call but must not lie before the time reached. Throws IntegratorFailure at the first
  /// derivative that is missing or not finite, and when min_step_s or max_steps_between_events ends
  /// the search for an accurate step.
  virtual double Step(double t_stop) = 0;

  /// y(t) for t within the last step: exactly the states it went between at its two ends, and in
  /// between the cubic with their derivatives (Runge–Kutta) or the method's own polynomial.
  virtual void Interpolate(double t, std::span<double> y) const = 0;

  /// The step [s] to hand to a Reset here, as it would be had no stop time cut the last one short.
  /// 0: the method starts again at order one and does better to estimate (kAdams, kBdf).
  virtual double next_step() const = 0;

  /// Counted since construction.
  virtual const Statistics& statistics() const = 0;

 protected:
  Integrator() = default;
};

std::unique_ptr<Integrator> MakeIntegrator(const IntegratorOptions& options, int states,
                                           Derivatives f);

}  // namespace pliant
