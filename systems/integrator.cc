#include "pliant/systems/integrator.h"

#include <cmath>

#include "pliant/systems/sundials_integrator.h"

namespace pliant {
namespace {

bool IsExplicitRungeKutta(Method method) {
  return method != Method::kSdirk && method != Method::kAdams && method != Method::kBdf;
}

void Validate(const IntegratorOptions& o) {
  const auto positive = [](double x) { return x > 0 && std::isfinite(x); };
  Require(o.relative_tolerance >= 1e-14 && o.relative_tolerance < 1,
          "relative_tolerance must lie between 1e-14 and 1", o.relative_tolerance);
  Require(positive(o.absolute_tolerance), "absolute_tolerance must be > 0", o.absolute_tolerance);
  Require(positive(o.max_step_s), "max_step_s must be > 0", o.max_step_s);
  Require(positive(o.min_step_s), "min_step_s must be > 0", o.min_step_s);
  Require(o.min_step_s <= o.max_step_s,
          "min_step_s must be at most max_step_s = " + Text(o.max_step_s), o.min_step_s);
  Require(o.initial_step_s == 0 || positive(o.initial_step_s), "initial_step_s must be ≥ 0",
          o.initial_step_s);
  Require(o.fixed_step_s == 0 || positive(o.fixed_step_s), "fixed_step_s must be ≥ 0",
          o.fixed_step_s);
  Require(o.fixed_step_s == 0 || IsExplicitRungeKutta(o.method),
          "fixed_step_s needs an explicit Runge–Kutta method", Name(o.method));
  Require(o.max_steps_between_events >= 1, "max_steps_between_events must be ≥ 1",
          o.max_steps_between_events);
}

}  // namespace

const char* Name(Method method) {
  switch (method) {
    case Method::kHeunEuler:
      return "heun_euler";
    case Method::kBogackiShampine:
      return "bogacki_shampine";
    case Method::kZonneveld:
      return "zonneveld";
    case Method::kSayfyAburub:
      return "sayfy_aburub";
    case Method::kCashKarp:
      return "cash_karp";
    case Method::kFehlberg:
      return "fehlberg";
    case Method::kDormandPrince:
      return "dormand_prince";
    case Method::kSdirk:
      return "sdirk";
    case Method::kAdams:
      return "adams";
    case Method::kBdf:
      return "bdf";
  }
  return "unknown";
}

IntegratorFailure::IntegratorFailure(double time, int element, const std::string& reason)
    : Error("cannot integrate past t = " + Text(time) + " s: " + reason +
            (element < 0 ? "" : " (state element " + Text(element) + ")")),
      time_{time},
      element_{element},
      reason_{reason} {}

std::unique_ptr<Integrator> MakeIntegrator(const IntegratorOptions& options, int states,
                                           Derivatives f) {
  Validate(options);
  Require(states >= 1, "an integrator needs at least 1 state", states);
  Require(static_cast<bool>(f), "an integrator needs a function of derivatives");
  return internal::MakeSundialsIntegrator(options, states, f);
}

}  // namespace pliant
