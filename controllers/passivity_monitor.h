#pragma once

#include "pliant/controllers/tool_impedance.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Whether an arm under null-space compliance gives out more than it was given, as its proof has
/// it:
///
///   ė_q = q̇_d − q̇
///   S = ½ ė_qᵀ M ė_q + ½ e_rᵀ K_ω e_r + ½ k_d ė_pᵀ D ė_p
///   excess = S(t) − S(0) − ∫ −ė_qᵀ τ_e ds ≤ 0
///
/// Exactly, and without what the proof neglects,
///
///   Ṡ = −ė_qᵀ τ_e − k_p ė_pᵀ D ė_p − ė_qᵀ (τⁿ + τ_f) + ė_qᵀ (M q̈_d + C q̇_d)
///
/// for the control law τ = g + τᶜ + τⁿ, one number for K_ω, J of full rank and ë_p without a
/// filter. So the excess may grow where q̇_d changes, where friction τ_f pulls along ė_q, where τⁿ
/// pushes along q̇, and where ë_p is filtered, sampled or late. M holds the rotors if `dynamics`
/// does.
///
/// The account begins at `from_s`; all is 0 until then. The integral is that of the trapezoidal
/// rule over the samples: a smooth supply p makes it wrong by at most h²/12 ∫|p̈|.
///
/// Source: Yang, Wang & Kermani 2025 (NS), III-C.
class PassivityMonitor final : public Block {
 public:
  struct Options {
    Joints joints;
    Eigen::Vector3d damping;    ///< D [N·s/m]
    Eigen::Vector3d stiffness;  ///< K_ω [N·m/rad]
    double rate_gain_s = 0;     ///< k_d [s]
    double from_s = 0;          ///< when the account begins, ≥ 0
    Duration period;
  };

  explicit PassivityMonitor(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointVelocity> desired_velocity;  ///< q̇_d
  Input<OrientationError> orientation_error{this, "orientation_error"};
  Input<LinearVelocity> velocity_error{this, "velocity_error"};  ///< ė_p
  Input<JointTorque> external_torque;                            ///< τ_e
  Output<double> storage{this, "storage"};                       ///< S [J]
  Output<double> supply{this, "supply"};                         ///< ∫ −ė_qᵀ τ_e [J]
  Output<double> excess{this, "excess"};                         ///< [J]

 private:
  struct Account {
    double storage = 0, first = 0, power = 0, supply = 0;
    bool started = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("storage", storage, "J");
      f("first", first, "J");
      f("power", power, "W");
      f("supply", supply, "J");
      f("started", started, "");
    }
  };

  Account Next(const Account& last, double t, const RobotDynamics& d, const JointVelocity& qd_dot,
               const OrientationError& e_r, const LinearVelocity& e_p,
               const JointTorque& tau_e) const;

  const Options o_;
  Output<Account> account_{this, "account"};
};

}  // namespace pliant
