#include "pliant/systems/sundials_integrator.h"

#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace pliant::internal {
namespace {

// The step size controller: PI of Söderlind as ARKODE sets it for explicit methods. Ours, because
// ARKODE does not tell which step it would try after a stop time.
constexpr double kErrorBias = 1.2;
constexpr double kSafety = 0.99;
constexpr double kMaxGrowth = 25;
constexpr double kSmallestError = 1e-10;

// Large enough for min_step_s to be the only limit that ends a series of rejections.
constexpr int kMaxRejections = 100;

// SUNDIALS takes times closer than 100 unit round-offs for one.
bool SameTime(double a, double b) {
  return std::abs(a - b) <= 100 * std::numeric_limits<double>::epsilon() * std::abs(b);
}

static_assert(ARK_ERR_FAILURE == CV_ERR_FAILURE && ARK_CONV_FAILURE == CV_CONV_FAILURE &&
              ARK_TOO_MUCH_ACC == CV_TOO_MUCH_ACC && ARK_ONE_STEP == CV_ONE_STEP);

void Check(int flag) {
  if (flag < 0) throw Error("SUNDIALS refuses its set-up with code " + Text(flag));
}

template <class T>
T* Check(T* created) {
  if (created == nullptr) throw Error("SUNDIALS cannot be set up: out of memory");
  return created;
}

void Silence(int, const char*, const char*, char*, void*) {}

struct SunContext {
  SunContext() { Check(SUNContext_Create(nullptr, &handle)); }
  ~SunContext() { SUNContext_Free(&handle); }
  SunContext(const SunContext&) = delete;
  SunContext& operator=(const SunContext&) = delete;
  SUNContext handle = nullptr;
};

template <auto kFree>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    kFree(object);
  }
};
template <auto kFree>
struct FreedByAddress {
  void operator()(void* memory) const { kFree(&memory); }
};
using Vector = std::unique_ptr<std::remove_pointer_t<N_Vector>, Freed<N_VDestroy>>;
using Matrix = std::unique_ptr<std::remove_pointer_t<SUNMatrix>, Freed<SUNMatDestroy>>;
using LinearSolver = std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, Freed<SUNLinSolFree>>;
using NonlinearSolver =
    std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, Freed<SUNNonlinSolFree>>;

std::span<double> Values(N_Vector v) {
  return {N_VGetArrayPointer(v), static_cast<std::size_t>(N_VGetLength(v))};
}

// With SUNDIALS' own, compiled without vectorization, a step of 14 states costs half as much again.
int LinearCombination(int terms, realtype* factors, N_Vector* vectors, N_Vector sum) {
  const sunindextype n = NV_LENGTH_S(sum);
  double* const z = NV_DATA_S(sum);
  const double* const x0 = NV_DATA_S(vectors[0]);
  for (sunindextype i = 0; i < n; ++i) z[i] = factors[0] * x0[i];
  for (int k = 1; k < terms; ++k) {
    const double c = factors[k];
    const double* const x = NV_DATA_S(vectors[k]);
    for (sunindextype i = 0; i < n; ++i) z[i] += c * x[i];
  }
  return 0;
}

/// What all packages of SUNDIALS share: state, right-hand side, counting, failures.
class SundialsIntegrator : public Integrator {
 public:
  SundialsIntegrator(const IntegratorOptions& options, int states, Derivatives f)
      : options_{options}, f_{f}, y_{NewVector(states)}, begin_(states) {
    // The solvers clone y_ with its operations.
    Check(N_VEnableFusedOps_Serial(y_.get(), SUNTRUE));
    y_->ops->nvlinearcombination = LinearCombination;
    std::ranges::fill(Values(y_.get()), 0.0);
  }

  /// Takes a step of ẏ = 0, since SUNDIALS allocates in its first one.
  void WarmUp() {
    const std::vector<double> zero(begin_.size());
    warming_up_ = true;
    Reset(0, zero, 0);
    Step(options_.max_step_s);
    warming_up_ = false;
    started_ = false;
    statistics_ = {};
  }

  void Reset(double t, std::span<const double> y, double h) final {
    Require(std::isfinite(t), "t must be finite", t);
    Require(y.size() == begin_.size(), "y must have one element for each state", y.size());
    Require(h >= 0 && std::isfinite(h), "h must be ≥ 0", h);
    std::ranges::copy(y, Values(y_.get()).begin());
    std::ranges::copy(y, begin_.begin());
    t_begin_ = t_ = t;
    steps_since_event_ = 0;
    restarted_ = true;
    Restart(h > 0 ? h : options_.initial_step_s);
    started_ = true;
  }

  double Step(double t_stop) final {
    Require(started_, "Reset must come before Step, also after a failure");
    Require(t_stop >= t_ && std::isfinite(t_stop), "t_stop must not lie before the time reached",
            t_stop);
    if (t_stop == t_ || SameTime(t_, t_stop)) {
      steps_since_event_ = 0;
      std::ranges::copy(Values(y_.get()), begin_.begin());
      t_begin_ = std::exchange(t_, t_stop);
      stands_ = true;
      return t_;
    }
    if (steps_since_event_ == options_.max_steps_between_events)
      Stop(t_, WorstElement(),
           "max_steps_between_events = " + Text(options_.max_steps_between_events) +
               " does not reach t = " + Text(t_stop) + " s");

    std::ranges::copy(Values(y_.get()), begin_.begin());
    t_begin_ = t_;
    stands_ = false;
    const long rejected_before = ErrorTestFailures();
    const int flag = Advance(t_stop);
    statistics_.rejected_steps += ErrorTestFailures() - rejected_before;
    if (flag < 0) Fail(flag);
    const double step = t_ - t_begin_;
    ++statistics_.steps;
    statistics_.shortest_step = std::min(statistics_.shortest_step, step);
    statistics_.longest_step = std::max(statistics_.longest_step, step);
    statistics_.integrated += step;
    steps_since_event_ = t_ == t_stop ? 0 : steps_since_event_ + 1;
    return t_;
  }

  void Interpolate(double t, std::span<double> y) const final {
    Require(y.size() == begin_.size(), "y must have one element for each state", y.size());
    Require(t_begin_ <= t && t <= t_, "t must lie within the last step", t);
    if (t == t_)
      std::ranges::copy(Values(y_.get()), y.begin());
    else if (t == t_begin_ || stands_)
      std::ranges::copy(begin_, y.begin());
    else
      InterpolateInside(t, y);
  }

  const Statistics& statistics() const final { return statistics_; }

 protected:
  Vector NewVector(int states) const { return Vector{Check(N_VNew_Serial(states, sun_.handle))}; }

  /// Starts the solver at (t_, y_).
  virtual void Restart(double h) = 0;
  /// One step towards t_stop from t_; sets t_ and y_.
  virtual int Advance(double t_stop) = 0;
  /// f at the time of the Reset.
  virtual void TakeFirstRate(std::span<const double>) {}
  virtual void InterpolateInside(double t, std::span<double> y) const = 0;
  virtual long ErrorTestFailures() const = 0;
  virtual void LocalErrors(N_Vector errors, N_Vector weights) const = 0;

  /// What SUNDIALS calls for f: 0, or −1 to give up at once.
  static int Rate(realtype t, N_Vector y, N_Vector rate, void* self) noexcept {
    return static_cast<SundialsIntegrator*>(self)->EvaluateRate(t, Values(y), Values(rate));
  }

  SunContext sun_;
  const IntegratorOptions options_;
  const Derivatives f_;
  double t_begin_ = 0, t_ = 0;
  Vector y_;                             // at t_; holds stages during a step
  std::vector<double> begin_;            // y at t_begin_
  bool stands_ = false;                  // the last step took no time: y is begin_ all along
  std::span<const double> last_rate_{};  // what the last call of f gave

 private:
  struct Refusal {
    double t;
    int element;
    std::string reason;
  };

  int EvaluateRate(double t, std::span<const double> y, std::span<double> rate) noexcept {
    ++statistics_.derivative_calls;
    if (warming_up_) {
      std::ranges::fill(rate, 0.0);
    } else {
      try {
        if (!f_(t, y, rate)) {
          refusal_ = Refusal{t, -1, "the derivatives cannot be evaluated"};
          return -1;
        }
        const auto bad = std::ranges::find_if_not(rate, [](double r) { return std::isfinite(r); });
        if (bad != rate.end()) {
          refusal_ =
              Refusal{t, static_cast<int>(bad - rate.begin()), "a derivative is " + Text(*bad)};
          return -1;
        }
      } catch (...) {
        thrown_ = std::current_exception();
        return -1;
      }
    }
    if (std::exchange(restarted_, false)) TakeFirstRate(rate);
    last_rate_ = rate;
    return 0;
  }

  [[noreturn]] void Stop(double t, int element, const std::string& reason) {
    started_ = false;
    throw IntegratorFailure(t, element, reason);
  }

  [[noreturn]] void Fail(int flag) {
    started_ = false;
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    if (refusal_) {
      const Refusal refusal = *std::exchange(refusal_, std::nullopt);
      Stop(refusal.t, refusal.element, refusal.reason);
    }
    const std::string smallest = "min_step_s = " + Text(options_.min_step_s) + " s";
    if (flag == ARK_ERR_FAILURE)
      Stop(t_begin_, WorstElement(), "the error is too large even with " + smallest);
    if (flag == ARK_CONV_FAILURE)
      Stop(t_begin_, WorstElement(),
           "the implicit equations have no solution even with " + smallest);
    if (flag == ARK_TOO_MUCH_ACC)
      Stop(t_begin_, -1,
           "relative_tolerance = " + Text(options_.relative_tolerance) + " is below round-off");
    Stop(t_begin_, -1, "SUNDIALS gives up with code " + Text(flag));
  }

  /// The element with the largest weighted local error, or −1 if no error is known.
  int WorstElement() const {
    const int states = static_cast<int>(begin_.size());
    const Vector errors = NewVector(states), weights = NewVector(states);
    std::ranges::fill(Values(errors.get()), 0.0);
    std::ranges::fill(Values(weights.get()), 1.0);
    LocalErrors(errors.get(), weights.get());
    int worst = -1;
    double largest = 0;
    for (int i = 0; i < states; ++i) {
      const double error = std::abs(Values(errors.get())[i] * Values(weights.get())[i]);
      if (error > largest) {
        largest = error;
        worst = i;
      }
    }
    return worst;
  }

  bool started_ = false;
  bool restarted_ = false;  // f is not evaluated yet
  bool warming_up_ = false;
  int steps_since_event_ = 0;
  Statistics statistics_;
  std::optional<Refusal> refusal_;
  std::exception_ptr thrown_;
};

/// The functions of ERKStep and ARKStep under common names.
struct ErkStep {
  static constexpr auto Free = ERKStepFree;
  static constexpr auto Reset = ERKStepReset;
  static constexpr auto Evolve = ERKStepEvolve;
  static constexpr auto SetUserData = ERKStepSetUserData;
  static constexpr auto SetErrHandlerFn = ERKStepSetErrHandlerFn;
  static constexpr auto SStolerances = ERKStepSStolerances;
  static constexpr auto SetInterpolantDegree = ERKStepSetInterpolantDegree;
  static constexpr auto SetMinStep = ERKStepSetMinStep;
  static constexpr auto SetMaxStep = ERKStepSetMaxStep;
  static constexpr auto SetInitStep = ERKStepSetInitStep;
  static constexpr auto SetFixedStep = ERKStepSetFixedStep;
  static constexpr auto SetStopTime = ERKStepSetStopTime;
  static constexpr auto SetMaxErrTestFails = ERKStepSetMaxErrTestFails;
  static constexpr auto SetAdaptivityFn = ERKStepSetAdaptivityFn;
  static constexpr auto SetErrorBias = ERKStepSetErrorBias;
  static constexpr auto SetSafetyFactor = ERKStepSetSafetyFactor;
  static constexpr auto SetMaxGrowth = ERKStepSetMaxGrowth;
  static constexpr auto SetMaxFirstGrowth = ERKStepSetMaxFirstGrowth;
  static constexpr auto SetFixedStepBounds = ERKStepSetFixedStepBounds;
  static constexpr auto GetNumErrTestFails = ERKStepGetNumErrTestFails;
  static constexpr auto GetEstLocalErrors = ERKStepGetEstLocalErrors;
  static constexpr auto GetErrWeights = ERKStepGetErrWeights;
};

struct ArkStep {
  static constexpr auto Free = ARKStepFree;
  static constexpr auto Reset = ARKStepReset;
  static constexpr auto Evolve = ARKStepEvolve;
  static constexpr auto SetUserData = ARKStepSetUserData;
  static constexpr auto SetErrHandlerFn = ARKStepSetErrHandlerFn;
  static constexpr auto SStolerances = ARKStepSStolerances;
  static constexpr auto SetInterpolantDegree = ARKStepSetInterpolantDegree;
  static constexpr auto SetMinStep = ARKStepSetMinStep;
  static constexpr auto SetMaxStep = ARKStepSetMaxStep;
  static constexpr auto SetInitStep = ARKStepSetInitStep;
  static constexpr auto SetFixedStep = ARKStepSetFixedStep;
  static constexpr auto SetStopTime = ARKStepSetStopTime;
  static constexpr auto SetMaxErrTestFails = ARKStepSetMaxErrTestFails;
  static constexpr auto SetAdaptivityFn = ARKStepSetAdaptivityFn;
  static constexpr auto SetErrorBias = ARKStepSetErrorBias;
  static constexpr auto SetSafetyFactor = ARKStepSetSafetyFactor;
  static constexpr auto SetMaxGrowth = ARKStepSetMaxGrowth;
  static constexpr auto SetMaxFirstGrowth = ARKStepSetMaxFirstGrowth;
  static constexpr auto SetFixedStepBounds = ARKStepSetFixedStepBounds;
  static constexpr auto GetNumErrTestFails = ARKStepGetNumErrTestFails;
  static constexpr auto GetEstLocalErrors = ARKStepGetEstLocalErrors;
  static constexpr auto GetErrWeights = ARKStepGetErrWeights;
};

/// Runge–Kutta methods: all that survives a Reset is the step size, which is handed in.
template <class Api>
class RungeKutta : public SundialsIntegrator {
 public:
  double next_step() const final {
    return options_.fixed_step_s > 0 ? options_.fixed_step_s : proposed_;
  }

 protected:
  RungeKutta(const IntegratorOptions& options, int states, Derivatives f)
      : SundialsIntegrator{options, states, f}, rate_begin_(states), rate_end_(states) {}

  /// Takes over what ERKStepCreate or ARKStepCreate made.
  void Configure(void* memory) {
    memory_.reset(Check(memory));
    Check(Api::SetErrHandlerFn(memory, Silence, nullptr));
    Check(Api::SetUserData(memory, static_cast<SundialsIntegrator*>(this)));
    Check(Api::SStolerances(memory, options_.relative_tolerance, options_.absolute_tolerance));
    // Only ever evaluated at the end of a step, where any degree is exact; 4 and 5 would call f.
    Check(Api::SetInterpolantDegree(memory, 1));
    Check(Api::SetMaxStep(memory, options_.max_step_s));
    Check(Api::SetMinStep(memory, options_.min_step_s));
    Check(Api::SetMaxErrTestFails(memory, kMaxRejections));
    if (options_.fixed_step_s > 0) {
      Check(Api::SetFixedStep(memory, options_.fixed_step_s));
    } else {
      Check(Api::SetAdaptivityFn(memory, Adapt, this));
      Check(Api::SetErrorBias(memory, kErrorBias));
      Check(Api::SetSafetyFactor(memory, kSafety));
      Check(Api::SetMaxGrowth(memory, kMaxGrowth));
      Check(Api::SetMaxFirstGrowth(memory, kMaxGrowth));
      Check(Api::SetFixedStepBounds(memory, 1, 1));
    }
  }

  void* memory() const { return memory_.get(); }

 private:
  void Restart(double h) final {
    Check(Api::Reset(memory(), t_, y_.get()));
    // Also forgets the errors of past steps, which Reset keeps.
    Check(Api::SetInitStep(memory(), options_.fixed_step_s > 0 ? options_.fixed_step_s : h));
    proposed_ = std::min(h, options_.max_step_s);
  }

  int Advance(double t_stop) final {
    rejected_ = false;
    rate_begin_.swap(rate_end_);
    Check(Api::SetStopTime(memory(), t_stop));
    const int flag = Api::Evolve(memory(), t_stop, y_.get(), &t_, ARK_ONE_STEP);
    // The last f of a step is the one at its end, from which the next step begins.
    if (flag >= 0) std::ranges::copy(last_rate_, rate_end_.begin());
    return flag;
  }

  void TakeFirstRate(std::span<const double> rate) final {
    std::ranges::copy(rate, rate_begin_.begin());
  }

  void InterpolateInside(double t, std::span<double> y) const final {
    const double h = t_ - t_begin_, s = (t - t_begin_) / h;
    const double y1 = s * s * (3 - 2 * s), f0 = h * s * (1 - s) * (1 - s), f1 = h * s * s * (s - 1);
    const std::span<const double> end = Values(y_.get());
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] = begin_[i] + y1 * (end[i] - begin_[i]) + f0 * rate_begin_[i] + f1 * rate_end_[i];
  }

  /// h_next = h e^(−0.8/p) e_last^(0.31/p), called after each attempt at a step of size h.
  static int Adapt(N_Vector, realtype, realtype h, realtype, realtype, realtype error,
                   realtype last_error, realtype, int, int p, realtype* next, void* self) {
    *next = h * std::pow(std::max(error, kSmallestError), -0.8 / p) *
            std::pow(std::max(last_error, kSmallestError), 0.31 / p);
    static_cast<RungeKutta*>(self)->Propose(h, error <= kErrorBias, *next);
    return ARK_SUCCESS;
  }

  /// Keeps the larger step that was wanted when a stop time allowed only h.
  void Propose(double h, bool accepted, double wanted) {
    const double step = std::max(options_.min_step_s,
                                 std::min({kSafety * wanted, kMaxGrowth * h, options_.max_step_s}));
    if (!accepted || rejected_)
      proposed_ = std::min(step, h);
    else
      proposed_ = h < proposed_ ? std::max(step, proposed_) : step;
    rejected_ = rejected_ || !accepted;
  }

  long ErrorTestFailures() const final {
    long failures = 0;
    Api::GetNumErrTestFails(memory(), &failures);
    return failures;
  }
  void LocalErrors(N_Vector errors, N_Vector weights) const final {
    if (options_.fixed_step_s > 0) return;
    Api::GetEstLocalErrors(memory(), errors);
    Api::GetErrWeights(memory(), weights);
  }

  std::unique_ptr<void, FreedByAddress<Api::Free>> memory_;
  std::vector<double> rate_begin_, rate_end_;
  double proposed_ = 0;
  bool rejected_ = false;
};

struct Table {
  ARKODE_ERKTableID id;
  // ARKODE takes the last stage of every table with c_s = 1 for f at the end of the step. Of these
  // two tables it is not: f is to be evaluated there.
  bool last_stage_is_not_the_end = false;
};

Table TableOf(Method method) {
  switch (method) {
    case Method::kHeunEuler:
      return {ARKODE_HEUN_EULER_2_1_2, true};
    case Method::kZonneveld:
      return {ARKODE_ZONNEVELD_5_3_4};
    case Method::kSayfyAburub:
      return {ARKODE_SAYFY_ABURUB_6_3_4, true};
    case Method::kCashKarp:
      return {ARKODE_CASH_KARP_6_4_5};
    case Method::kFehlberg:
      return {ARKODE_FEHLBERG_6_4_5};
    case Method::kDormandPrince:
      return {ARKODE_DORMAND_PRINCE_7_4_5};
    default:
      return {ARKODE_BOGACKI_SHAMPINE_4_2_3};
  }
}

class ExplicitRungeKutta final : public RungeKutta<ErkStep> {
 public:
  ExplicitRungeKutta(const IntegratorOptions& options, int states, Derivatives f)
      : RungeKutta{options, states, f} {
    Configure(ERKStepCreate(Rate, 0, y_.get(), sun_.handle));
    const Table table = TableOf(options.method);
    Check(ERKStepSetTableNum(memory(), table.id));
    if (table.last_stage_is_not_the_end)  // a function after the step makes ERKStep evaluate f
      Check(ERKStepSetPostprocessStepFn(memory(), [](realtype, N_Vector, void*) { return 0; }));
  }
};

class ImplicitRungeKutta final : public RungeKutta<ArkStep> {
 public:
  ImplicitRungeKutta(const IntegratorOptions& options, int states, Derivatives f)
      : RungeKutta{options, states, f},
        jacobian_{Check(SUNDenseMatrix(states, states, sun_.handle))},
        solver_{Check(SUNLinSol_Dense(y_.get(), jacobian_.get(), sun_.handle))} {
    Configure(ARKStepCreate(nullptr, Rate, 0, y_.get(), sun_.handle));
    Check(ARKStepSetTableNum(memory(), ARKODE_SDIRK_5_3_4, ARKODE_ERK_NONE));
    Check(ARKStepSetLinearSolver(memory(), solver_.get(), jacobian_.get()));
    Check(ARKStepSetMaxConvFails(memory(), kMaxRejections));
  }

 private:
  const Matrix jacobian_;
  const LinearSolver solver_;
};

/// CVODE: Adams with fixed-point iteration, BDF with Newton's and a Jacobian by differences.
class Multistep final : public SundialsIntegrator {
 public:
  Multistep(const IntegratorOptions& options, int states, Derivatives f)
      : SundialsIntegrator{options, states, f} {
    const bool stiff = options.method == Method::kBdf;
    memory_.reset(Check(CVodeCreate(stiff ? CV_BDF : CV_ADAMS, sun_.handle)));
    Check(CVodeSetErrHandlerFn(memory(), Silence, nullptr));
    Check(CVodeInit(memory(), Rate, 0, y_.get()));
    Check(CVodeSetUserData(memory(), static_cast<SundialsIntegrator*>(this)));
    Check(CVodeSStolerances(memory(), options.relative_tolerance, options.absolute_tolerance));
    Check(CVodeSetMaxStep(memory(), options.max_step_s));
    Check(CVodeSetMinStep(memory(), options.min_step_s));
    Check(CVodeSetMaxErrTestFails(memory(), kMaxRejections));
    Check(CVodeSetMaxConvFails(memory(), kMaxRejections));
    if (stiff) {
      jacobian_.reset(Check(SUNDenseMatrix(states, states, sun_.handle)));
      linear_.reset(Check(SUNLinSol_Dense(y_.get(), jacobian_.get(), sun_.handle)));
      Check(CVodeSetLinearSolver(memory(), linear_.get(), jacobian_.get()));
    } else {
      fixed_point_.reset(Check(SUNNonlinSol_FixedPoint(y_.get(), 0, sun_.handle)));
      Check(CVodeSetNonlinearSolver(memory(), fixed_point_.get()));
    }
    dense_output_.reset(Check(N_VNewEmpty_Serial(states, sun_.handle)));
  }

  double next_step() const override { return 0; }

 private:
  void Restart(double h) override {
    Check(CVodeReInit(memory(), t_, y_.get()));
    Check(CVodeSetInitStep(memory(), h));
  }

  int Advance(double t_stop) override {
    Check(CVodeSetStopTime(memory(), t_stop));
    return CVode(memory(), t_stop, y_.get(), &t_, CV_ONE_STEP);
  }

  void InterpolateInside(double t, std::span<double> y) const override {
    N_VSetArrayPointer(y.data(), dense_output_.get());
    Check(CVodeGetDky(memory(), t, 0, dense_output_.get()));
  }

  long ErrorTestFailures() const override {
    long failures = 0;
    CVodeGetNumErrTestFails(memory(), &failures);
    return failures;
  }
  void LocalErrors(N_Vector errors, N_Vector weights) const override {
    CVodeGetEstLocalErrors(memory(), errors);
    CVodeGetErrWeights(memory(), weights);
  }

  void* memory() const { return memory_.get(); }

  Matrix jacobian_;
  LinearSolver linear_;
  NonlinearSolver fixed_point_;
  std::unique_ptr<void, FreedByAddress<CVodeFree>> memory_;
  Vector dense_output_;  // without values of its own
};

template <class Kind>
std::unique_ptr<Integrator> Made(const IntegratorOptions& options, int states, Derivatives f) {
  auto integrator = std::make_unique<Kind>(options, states, f);
  integrator->WarmUp();
  return integrator;
}

}  // namespace

std::unique_ptr<Integrator> MakeSundialsIntegrator(const IntegratorOptions& options, int states,
                                                   Derivatives f) {
  switch (options.method) {
    case Method::kSdirk:
      return Made<ImplicitRungeKutta>(options, states, f);
    case Method::kAdams:
    case Method::kBdf:
      return Made<Multistep>(options, states, f);
    default:
      return Made<ExplicitRungeKutta>(options, states, f);
  }
}

}  // namespace pliant::internal
