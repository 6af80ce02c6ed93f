#include "pliant/systems/integrator.h"

#include "pliant/systems/sundials_integrator.h"
#include "pliant/systems/time_text.h"

namespace pliant {
namespace {

bool IsExplicitRungeKutta(Method method) {
  return method != Method::kSdirk && method != Method::kAdams && method != Method::kBdf;
}

void Validate(const IntegratorOptions& o) {
  RequireInRange("", o);
  Require(o.min_step_s <= o.max_step_s,
          "min_step_s must be at most max_step_s = " + Text(o.max_step_s), o.min_step_s);
  Require(o.fixed_step_s == 0 || IsExplicitRungeKutta(o.method),
          "fixed_step_s needs an explicit Runge–Kutta method", Name(o.method));
}

}  // namespace

const std::vector<std::string>& Words(Method) {
  static const std::vector<std::string> words{
      "heun_euler", "bogacki_shampine", "zonneveld", "sayfy_aburub", "cash_karp",
      "fehlberg",   "dormand_prince",   "sdirk",     "adams",        "bdf"};
  return words;
}

std::string Integrator::Statistics::text() const {
  if (steps == 0) return "no step";
  return Text(steps) + (steps == 1 ? " step" : " steps") + " of " + TimeText(shortest_step) +
         " to " + TimeText(longest_step) + ", " + TimeText(mean_step()) + " on average, " +
         Text(rejected_steps) + " rejected; " + Text(derivative_calls) + " derivative calls";
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
