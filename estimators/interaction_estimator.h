#pragma once

#include <optional>
#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Where an arm is taken to be touched.
struct InteractionPoint {
  std::string link;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in the link's frame [m]

  template <class F>
  void Parameters(F&& f) {
    f("link", link);
    f("point", point, "m");
  }
};

/// The interaction by recursive least squares that forget. What an arm's motion says of the
/// external torque over one sample is linear in what is looked for, θ:
///
///   y_k = (p_k − p_{k−1})/h − τ_k − β̄_k = Φ_k θ + noise,   β = Cᵀ q̇ − g
///   Φ = I: θ is the torque τ_e        Φ = J_cᵀ: θ is the force at a point c of the arm
///
/// θ_k is the least of Σ_i λ^{k−i} ‖y_i − Φ_i θ‖² + r₀ ‖θ‖², λ = e^{−h/T}:
///
///   R_k = λ R_{k−1} + Φ_kᵀ Φ_k + (1 − λ) r₀ I,   R_0 = r₀ I
///   z_k = λ z_{k−1} + Φ_kᵀ y_k,   θ_k = R_k⁻¹ z_k,   τ̂_e = Φ_k θ_k
///
/// What the samples do not excite is forgotten towards 0: R_k ⪰ r₀ I always, so the covariance
/// R_k⁻¹ is at most I/r₀, and nothing winds up. That costs a part r₀/(r₀ + s) of θ, s what the
/// samples that are remembered say of it: with Φ = I, s → 1/(1 − λ).
///
/// With Φ = I, R is a number, and once it has settled
///
///   θ_k = λ θ_{k−1} + (1 − λ)/(1 + r₀ (1 − λ)) y_k
///
/// which is a momentum observer with K_I = 1/T, exactly discretized, but for the part that r₀
/// takes: no other estimate under another name. What least squares add comes with a point.
///
/// The momentum is that of MomentumObserver, with the rotors taken off in the same way.
///
/// Source: Ljung & Söderström, Theory and Practice of Recursive Identification, 1983, 2.2 and 5.6.
class InteractionEstimator final : public Block {
 public:
  struct Options {
    RobotModel model;
    double memory_s;                          ///< T > 0
    double prior = 1;                         ///< r₀ > 0
    std::optional<InteractionPoint> at = {};  ///< c; none: Φ = I
    PerJoint rotor_inertia = {};  ///< B in `dynamics` but not in τ [kg·m²], each ≥ 0; empty: none
    Duration period;              ///< h
  };

  explicit InteractionEstimator(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> torque;            ///< τ, as measured
  Output<JointTorque> external_torque;  ///< τ̂_e
  Output<Force> force{this, "force"};   ///< θ at c, world axes; 0 with Φ = I
  Output<JointMatrix> information;      ///< R

 private:
  struct Memory {
    using Space = Joints;
    static constexpr Quantity quantity{"interaction estimator memory", ""};

    JointMatrix R;
    PerJoint z, theta;
    JointTorque estimate;  // τ̂_e
    JointMomentum p;       // of the links
    JointTorque beta;      // Cᵀ q̇ − g
    bool started = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("R", R, "");
      f("z", z, "");
      f("theta", theta, "");
      f("estimate", estimate, "N·m");
      f("p", p, "N·m·s");
      f("beta", beta, "N·m");
      f("started", started, "");
    }
  };

  static Memory Blank(const Options& o);
  Memory Next(const Memory& last, const RobotDynamics& d, const JointTorque& tau) const;

  const RobotModel model_;
  const int link_;  // −1: Φ = I
  const Eigen::Vector3d point_;
  const PerJoint B_;
  const double h_, lambda_, prior_;
  Output<Memory> memory_;
};

}  // namespace pliant
