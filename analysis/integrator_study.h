#pragma once

#include "pliant/analysis/progress.h"
#include "pliant/analysis/report.h"
#include "pliant/plants/simbody_plant.h"
#include "pliant/systems/integrator.h"

namespace pliant {

/// Which integrator to take for what: every method on a swaying Gen3, once as a smooth system, once
/// under a controller that samples and holds at 1 kHz, once with elastic gears, dry friction and
/// noisy sensors besides. Each is compared with a reference at a relative tolerance of 1e-12; then
/// the full station runs long enough to balance its energy:
///
///   E(t) − E(0) = ∫ τ_m ω dt − ∫ dissipation dt
///
/// The integrals are states beside the arm's, so their error is controlled like the arm's. Heun and
/// Euler's method is left out there: at order two, 60 s would take it minutes.
struct IntegratorStudyOptions {
  std::vector<Method> methods = {Method::kHeunEuler,     Method::kBogackiShampine,
                                 Method::kZonneveld,     Method::kSayfyAburub,
                                 Method::kCashKarp,      Method::kFehlberg,
                                 Method::kDormandPrince, Method::kSdirk,
                                 Method::kAdams,         Method::kBdf};
  std::vector<double> relative_tolerances = {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
  double compared_s = 0.5;  ///< of each run against the reference
  double balanced_s = 60;   ///< of each run whose energy is balanced
  int repetitions = 3;      ///< of which the median time counts
  std::uint64_t seed = 1;   ///< of the sensors' noise
  SimbodyPlant::Engine engine = SimbodyPlant::Engine::Recursive;
};

Report IntegratorStudy(const IntegratorStudyOptions& options, const Progress& progress);

}  // namespace pliant
