#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// The external torque from the momentum p = M q̇ by a sliding mode: a torque that changes by no
/// more than L is found in finite time and followed without lag. With s = p − p̂,
///
///   p̂' = τ + Cᵀ q̇ − g + σ + k₁ |s|^½ sgn(s),   σ' = k₃ sgn(s),   σ estimates τ_e
///   k₁ = 1.5 √L,   k₃ = 1.1 L
///
/// sampled every h by the implicit Euler rule, which does not chatter: with the torque of a sample
/// τ̄_k = (p_k − p_{k−1})/h − τ_k − β̄_k of MomentumObserver, and b = s_{k−1} + h τ̄_k − h σ_{k−1},
///
///   |b| ≤ h² k₃:   s_k = 0,                                        σ_k = σ_{k−1} + b/h
///   else:          |s_k|^½ = ½ (−h k₁ + √(h² k₁² + 4 (|b| − h² k₃))),   sgn(s_k) = sgn(b)
///                  σ_k = σ_{k−1} + h k₃ sgn(b)
///
/// Where `dynamics` holds M + diag(B) though torque sensors behind the gears do not feel the
/// rotors, p = (M + diag(B)) q̇ − B ∘ q̇, as in MomentumObserver.
///
/// So once s is 0 it stays 0, and σ_k = τ̄_k, as long as τ̄ changes by no more than h k₃ in a
/// sample. Noise of p is not filtered beyond that: L is to be no larger than torques ask for.
///
/// Source: Levant, Automatica 34(3), 1998; Garofalo, Mansfeld, Jankowski & Ott, ICRA 2019;
/// Brogliato, Polyakov & Efimov, IEEE Trans. Automatic Control 65(8), 2020 (the implicit rule).
class SuperTwistingObserver final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint rate;                ///< L [N·m/s], each > 0
    Duration period;              ///< h
    PerJoint rotor_inertia = {};  ///< B in `dynamics` but not in τ [kg·m²], each ≥ 0; empty: none
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    using Space = Joints;
    static constexpr Quantity quantity{"super-twisting observer memory", ""};

    JointTorque sigma;  ///< σ
    JointMomentum s;    ///< p − p̂
    JointMomentum p;    ///< of the links
    JointTorque beta;   ///< Cᵀ q̇ − g
    bool started = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("sigma", sigma, "N·m");
      f("s", s, "N·m·s");
      f("p", p, "N·m·s");
      f("beta", beta, "N·m");
      f("started", started, "");
    }
  };

  explicit SuperTwistingObserver(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> torque;     ///< τ, as measured
  Output<JointTorque> residual;  ///< σ, an estimate of τ_e

 private:
  Memory Next(const Memory& last, const RobotDynamics& d, const JointTorque& tau) const;

  const PerJoint k1_, k3_;
  const PerJoint B_;
  const double h_;
  Output<Memory> memory_;
};

}  // namespace pliant
