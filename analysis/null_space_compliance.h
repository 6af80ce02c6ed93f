#pragma once

#include <cstdint>

#include "pliant/analysis/experiment.h"
#include "pliant/plants/simbody_plant.h"

namespace pliant {

/// The figure on explicit compliance of Celerier et al. 2025 (EC-fig6): a Gen3 holds the pose of
/// its tool stiffly while it is pushed at the elbow and at the tool. The same gains, three
/// compliances: none (Γ = 0), in the null space (Γ₀ = I), everywhere (all Γ = I).
struct NullSpaceComplianceOptions {
  double duration_s = 6;
  double push_N = 30;         ///< at the elbow and, later, at the tool; well above the friction
  double observer_gain = 50;  ///< K_I [1/s]
  bool ideal = false;         ///< torque sources and sensors without error
  std::uint64_t seed = 1;     ///< of the sensors' noise
  SimbodyPlant::Engine engine = SimbodyPlant::Engine::Simbody;
};

Report NullSpaceCompliance(const NullSpaceComplianceOptions& options, const Progress& progress);

}  // namespace pliant
