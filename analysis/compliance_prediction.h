#pragma once

#include <Eigen/Core>

#include "pliant/analysis/series.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/signal.h"
#include "pliant/systems/time.h"

namespace pliant {

/// What a task that gives way nowhere (Γ = 0) still deviates, because its controller learns of the
/// push a late through an observer with gain K:
///
///   E(s) = s / ((s + K)(s² + λ₁ s + λ₂)) A(s),   a = J M⁻¹ τ_e
///
/// row by row, from rest; exact for an a that is held from sample to sample. e has a's unit times
/// s².
Series DeviationBehindObserver(const Series& a, double observer_gain, double damping,
                               double stiffness, Duration period);

/// What pushes a task at each sample: J M⁻¹ τ_e, 6 rows in world axes, angular first [rad/s²,
/// m/s²]. q, tau_e: a column per sample. B: reflected rotor inertia, part of M; empty: none.
Series TaskAcceleration(const RobotModel& model, std::string_view frame, const Series& q,
                        const Series& tau_e, const PerJoint& rotor_inertia);

}  // namespace pliant
