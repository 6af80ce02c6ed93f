#pragma once

#include "pliant/controllers/friction_compensation.h"
#include "pliant/controllers/torque_loop.h"

namespace pliant {

/// Joint torque control of geared motors, every h. With the torque τ_d that is wanted of the
/// motors, rotors included, and e = τ_d − B q̈_d − τ the torque that is missing behind the gears:
///
///   τ_m = τ_d + τ_f(q̇, q̈_d) + λ H(z) e + l,   i = clamp(τ_m/κ, ± i_max)
///
///   torque ───────────────────────────────────┐
///   acceleration ─▶ friction ─────────────────┤
///   measured_velocity ─▶ ┘                    ├─▶ sum ─▶ motor ─▶ current, saturated
///   measured_torque ─▶ error ─▶ lag ──────────┤             │
///                        └────▶ room ─▶ leak ─┘             │
///                                └──────── side ◀───────────┘
///
/// H is KinovaLag; l the leaky integral K_I/(1 + θ s) e, clamped to ± `leak_limit`. Of e it gets
/// nothing that would drive a current further that is cut. κ is the torque per ampere behind the
/// gear. A gain of 0 switches its part off, and so do the flags; without `rotor_feedforward` τ_d
/// counts without B q̈_d.
/// Source: Muraccioli et al. 2025 (RSS).
class LowLevelTorque final : public TorqueLoop {
 public:
  struct Options {
    Joints joints;
    PerJoint torque_per_ampere;              ///< κ [N·m/A], each > 0
    PerJoint reflected_inertia;              ///< B [kg·m²], each ≥ 0
    MotorCurrent current_limit = {};         ///< i_max [A], each > 0; empty: none
    FrictionCompensation::Options friction;  ///< joints are filled in
    bool friction_feedforward = true;        ///< τ_f
    bool rotor_feedforward = true;           ///< B q̈_d in τ_m
    double lag_gain = 5;                     ///< λ
    double leak_gain = 10;                   ///< K_I
    double leak_time_s = 2;                  ///< θ
    JointTorque leak_limit;                  ///< [N·m], each ≥ 0; in the paper 5 % of the limits
    Duration period;
  };

  explicit LowLevelTorque(const Options& o);
};

}  // namespace pliant
