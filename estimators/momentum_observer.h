#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// The external torque that explains how the momentum p = M q̇ changes:
///
///   r = K [ p(t) − ∫ (τ + Cᵀ q̇ − g + r) ds − p(0) ]   ⇒   ṙ = K (τ_e − r)
///
/// sampled every h, exact for a momentum that changes evenly over the sample that ends at tick k:
///
///   r_k = e^{−K h} r_{k−1} + (1 − e^{−K h}) [ (p_k − p_{k−1})/h − τ_k − β̄_k ],   β = Cᵀ q̇ − g
///
/// with β̄ the mean of its values at the two ends and τ_k the torque that acted between them. Sums
/// of p_k − p_{k−1} telescope, so nothing drifts. r_0 = 0.
///
/// Torque sensors behind the gears do not feel what turns the rotors. Where `dynamics` holds
/// M + diag(B) all the same, the momentum that belongs to τ is that of the links alone,
///
///   p = (M + diag(B)) q̇ − B ∘ q̇
///
/// Source: De Luca & Mattone, ICRA 2005; Celerier et al. 2025 (25).
class MomentumObserver final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint gain;                ///< K [1/s], each > 0
    Duration period;              ///< h
    PerJoint rotor_inertia = {};  ///< B in `dynamics` but not in τ [kg·m²], each ≥ 0; empty: none
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    using Space = Joints;
    static constexpr Quantity quantity{"momentum observer memory", ""};

    JointTorque r;     ///< the residual
    JointMomentum p;   ///< of the links
    JointTorque beta;  ///< Cᵀ q̇ − g
    bool started = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("r", r, "N·m");
      f("p", p, "N·m·s");
      f("beta", beta, "N·m");
      f("started", started, "");
    }
  };

  explicit MomentumObserver(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> torque;     ///< τ, as measured
  Output<JointTorque> residual;  ///< r, an estimate of τ_e

 private:
  Memory Next(const Memory& last, const RobotDynamics& d, const JointTorque& tau) const;

  const PerJoint decay_;  // e^{−K h}
  const PerJoint B_;
  const double h_;
  Output<Memory> memory_;
};

}  // namespace pliant
