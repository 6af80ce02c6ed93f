#pragma once

#include <cstdint>

#include "pliant/systems/block.h"
#include "pliant/systems/random.h"

namespace pliant {

/// The sensors in the joints of an arm: samples of position q, velocity v, torque τ and motor
/// current i, taken every h and held,
///
///   q̂_k = Δ round((q_k + σ_q ξ_k) / Δ)
///   v̂_k = v̂_{k−1} + α ((q̂_k − q̂_{k−1})/h − v̂_{k−1}),   α = 1 − exp(−2π f h),   v̂_0 = v_0
///   τ̂_k = τ_k + b + d_k + σ_τ ξ_k,   d_k = a d_{k−1} + σ_d √(1 − a²) ξ_k,   a = exp(−h/T)
///   î_k = i_k + σ_i ξ_k
///
/// with a ξ_k ~ N(0, 1) of its own for each use, joint and tick, which the seed decides. At tick k
/// the torque is the one that acted up to then, u_{k−1}. An option left out has no effect.
///
/// v̂ is what the arm's own filter makes of its positions; without f it is v_k + σ_v ξ_k. The filter
/// turns the noise ξ of the positions into (α/h) [ξ_k − α Σ_{j≥1} (1 − α)^{j−1} ξ_{k−j}] σ_q, thus
///
///   σ_v̂ = (σ_q/h) α √(2/(2 − α)),   delay h/2 + h (1 − α)/α
///
/// where half a sample comes from the difference. Its response is H(z) = α (1 − z⁻¹) / (h (1 −
/// (1 − α) z⁻¹)).
///
/// d is a sampled Ornstein–Uhlenbeck process, exact for any h: standard deviation σ_d from the
/// first tick on, autocorrelation exp(−|t|/T). Source: Gillespie, Phys. Rev. E 54 (1996) 2084.
class JointSensors final : public Block {
 public:
  struct Options {
    Joints joints;
    Duration period;                   ///< h
    PerJoint position_quantum = {};    ///< Δ [rad], each ≥ 0
    PerJoint position_noise = {};      ///< σ_q [rad], each ≥ 0
    PerJoint velocity_cutoff_hz = {};  ///< f, each ≥ 0; 0: the true velocity is sampled
    PerJoint velocity_noise = {};      ///< σ_v [rad/s], each ≥ 0 and 0 where f > 0
    PerJoint torque_noise = {};        ///< σ_τ [N·m], each ≥ 0
    PerJoint torque_bias = {};         ///< b [N·m]
    PerJoint torque_drift = {};        ///< σ_d [N·m], each ≥ 0
    double torque_drift_time_s = 600;  ///< T > 0
    PerJoint current_noise = {};       ///< σ_i [A], each ≥ 0
    std::uint64_t seed = 0;
  };

  explicit JointSensors(const Options& o);

  Input<JointPosition> position;
  Input<JointVelocity> velocity;
  Input<JointTorque> torque;
  Input<MotorCurrent> current;  ///< 0 if not connected
  Output<JointPosition> measured_position;
  Output<JointVelocity> measured_velocity;
  Output<JointTorque> measured_torque;
  Output<MotorCurrent> measured_current;

 private:
  JointPosition MeasurePosition(const JointPosition& q, double t) const;
  JointVelocity MeasureVelocity(const JointVelocity& last, const JointPosition& q,
                                const JointPosition& last_q, const JointVelocity& v,
                                double t) const;
  JointTorque Drift(const JointTorque& last, double t) const;
  JointTorque MeasureTorque(const JointTorque& tau, const JointTorque& drift, double t) const;
  MotorCurrent MeasureCurrent(const MotorCurrent& i, double t) const;

  const double h_;
  const PerJoint quantum_, sigma_q_, alpha_, sigma_v_, sigma_tau_, bias_, sigma_d_, sigma_i_;
  const double a_, fresh_;  // fresh = √(1 − a²)
  const RandomStream random_;
  Discrete<JointPosition> last_position_;  // q̂_{k−1}
  Output<JointTorque> drift_;              // d
};

/// The sensors of a Kinova Gen3: σ_q = 1e-5 rad and f = 95 Hz, so that σ_v̂ = 0.005 rad/s at 1 kHz;
/// Δ = 5e-7 rad, single precision near 360°; σ_τ = 0.15 N·m in the large joints 1–4 and 0.08 N·m in
/// the small ones; b uniform within ±0.5 N·m, as the seed decides; σ_d = 0.05 N·m, T = 600 s.
///
/// Kinova publishes none but the protocol's precision. The noise is that of a Franka Panda in
/// motion above 50 Hz, the offset what remains of those that users report once they are zeroed, the
/// drift a guess.
JointSensors::Options Gen3JointSensors(const Joints& joints, Duration period, std::uint64_t seed);

}  // namespace pliant
