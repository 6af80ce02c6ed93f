#pragma once

#include "pliant/controllers/torque_loop.h"

namespace pliant {

/// The torque loop of a Kinova arm's mode "torque, high velocity", every h:
///
///   τ_m = f τ_d + k H(z) (τ_d − τ),   i = clamp(τ_m/κ, ± i_max)
///
/// H is KinovaLag. What the vendor adds to it is not published, so f and k are parameters. At rest
/// and without friction τ = (f + k)/(1 + k) τ_d: without f the loop is weak. What is commanded
/// holds the rotors' torque as well, of which sensors behind the gears see nothing; the loop does
/// not know.
/// Source: Muraccioli et al. 2025 (RSS), the baseline.
class KinovaHighVelocityTorque : public TorqueLoop {
 public:
  struct Options {
    Joints joints;
    PerJoint torque_per_ampere;       ///< κ [N·m/A], each > 0
    PerJoint reflected_inertia;       ///< B of `error` [kg·m²], each ≥ 0
    MotorCurrent current_limit = {};  ///< i_max [A], each > 0; empty: none
    double feedforward = 1;           ///< f
    double gain = 1;                  ///< k
    Duration period;                  ///< that of KinovaLag
  };

  explicit KinovaHighVelocityTorque(const Options& o) : KinovaHighVelocityTorque(o, 0) {}

 protected:
  KinovaHighVelocityTorque(const Options& o, double damping);
};

/// That of its mode "torque", which has a velocity loop inside:
///
///   τ_m = f τ_d + k H(z) (τ_d − τ) − d q̇
class KinovaDampedTorque final : public KinovaHighVelocityTorque {
 public:
  struct Options {
    KinovaHighVelocityTorque::Options torque;
    double damping = 10;  ///< d [N·m·s/rad] ≥ 0; identified of one such arm: 7 to 10
  };

  explicit KinovaDampedTorque(const Options& o) : KinovaHighVelocityTorque(o.torque, o.damping) {}
};

}  // namespace pliant
