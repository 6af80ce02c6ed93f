#pragma once

#include <memory>

#include "pliant/systems/integrator.h"

namespace pliant::internal {

/// What MakeIntegrator returns, for options that are already checked.
std::unique_ptr<Integrator> MakeSundialsIntegrator(const IntegratorOptions& options, int states,
                                                   Derivatives f);

}  // namespace pliant::internal
