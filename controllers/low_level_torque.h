#pragma once

#include "pliant/controllers/friction_compensation.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// Joint torque control of geared motors, every h. With the torque τ_d that is wanted of the
/// motors, rotors included, and e = τ_d − B q̈_d − τ the torque that is missing behind the gears:
///
///   τ_m = τ_d + τ_f(q̇, q̈_d) + λ H(z) e + l,   i = τ_m/κ
///
///   torque ──────────────────────────────────┐
///   acceleration ─▶ friction ────────────────┤
///   measured_velocity ─▶ ┘                   ├─▶ sum ─▶ current
///   measured_torque ─▶ error ─▶ lag ─────────┤
///                        └────▶ leak ────────┘
///
/// H is KinovaLag; l the leaky integral K_I/(1 + θ s) e, clamped to ± `leak_limit`. κ is the torque
/// per ampere behind the gear. A gain of 0 switches its part off.
/// Source: Muraccioli et al. 2025 (RSS).
class LowLevelTorque final : public Composite {
 public:
  struct Options {
    Joints joints;
    PerJoint torque_per_ampere;              ///< κ [N·m/A], each > 0
    PerJoint reflected_inertia;              ///< B [kg·m²], each ≥ 0
    FrictionCompensation::Options friction;  ///< joints are filled in
    double lag_gain = 5;                     ///< λ
    double leak_gain = 10;                   ///< K_I
    double leak_time_s = 2;                  ///< θ
    JointTorque leak_limit;                  ///< [N·m], each ≥ 0; in the paper 5 % of the limits
    Duration period;
  };

  explicit LowLevelTorque(const Options& o);

  Input<JointTorque> torque;              ///< τ_d = M q̈_d + C q̇ + g − τ̂_e + B q̈_d
  Input<JointAcceleration> acceleration;  ///< q̈_d
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;  ///< τ
  Output<MotorCurrent> current;        ///< i
  Output<JointTorque> error;           ///< e
};

}  // namespace pliant
