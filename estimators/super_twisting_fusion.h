#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// The external torque from a wrist sensor and, for what the sensor does not tell, a sliding mode
/// that follows without lag:
///
///   p̂' = τ + τ_s + Cᵀ q̇ − g + σ + k₁ |s|^½ sgn(s),   σ' = k₃ sgn(s),   s = p − p̂
///   τ̂_e = τ_s + σ,   τ_s = J_sᵀ F_s
///
///   torque, sensor_torque ─▶ known ─▶ observer ─▶ residual ─▶ + sensor_torque ─▶ external_torque
///
/// SuperTwistingObserver with the sensor's torque as a torque that is known: over the sample that
/// ends at tick k it is the mean of its ends,
///
///   τ_k + ½ (τ_s,k + τ_s,k−1)
///
/// σ estimates τ_e − τ_s and finds it in finite time where that changes by no more than the rate,
///
///   |d/dt (τ_e − τ_s)| ≤ L,
///
/// however fast τ_e is. From then on, with a sensor that is smooth over a sample,
///
///   |τ̂_e − τ_e| ≤ ½ h L + h²/12 |τ̈_s|
///
/// The mean of the ends misses the mean by that last term; its rate, h²/12 |τ⃛_s|, is part of what
/// L is for.
///
/// τ_e − τ_s holds what touches the arm before the sensor, the noise and offset of the sensor, what
/// moves the tool, and, of a push that rises at V, what the sensor's delay holds back: up to V.
///
/// While the sensor is not valid, its last torque stands in for τ_s. What it was is then no more
/// than an offset of σ, which is found with it: τ̂_e is what the observer alone says that goes on
/// from there. What the sensor shows when it is valid again is off from what stood in for it by an
/// offset o, and is taken off by that from then on, so that nothing jumps:
///
///   s_k = τ_s,k − o while valid,   s_k = s_{k−1} otherwise,   τ̂_e = s + σ_o,   σ = σ_o + s − τ_s
///
/// with σ_o of the equations above, s for τ_s. Until the first loss o = 0; while not valid, τ_s = 0
/// in what is shown as σ, which is τ̂_e.
///
/// Source: SuperTwistingObserver; Celerier et al. 2025, sec. VI, which names the combination.
class SuperTwistingFusion final : public Composite {
 public:
  struct Options {
    Joints joints;
    PerJoint rate;                ///< L [N·m/s], each > 0
    Duration period;              ///< h
    PerJoint rotor_inertia = {};  ///< B in `dynamics` but not in τ [kg·m²], each ≥ 0; empty: none
  };

  explicit SuperTwistingFusion(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> torque;         ///< τ, as measured
  Input<JointTorque> sensor_torque;  ///< τ_s
  Input<bool> sensor_valid;          ///< true if not connected
  Output<JointTorque> residual;      ///< σ, an estimate of τ_e − τ_s; of τ_e while not valid
  Output<JointTorque> external_torque;  ///< τ̂_e
};

}  // namespace pliant
