#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// log(R_d Rᵀ): the turn that is missing, axis times angle, world axes.
struct OrientationError : Signal<OrientationError, Frame, 3> {
  using Signal::Signal;
  static constexpr Quantity quantity{"orientation error", "rad"};
};

/// [moment; force] that an arm's tool is commanded to exert on itself, world axes.
struct ToolWrench : Signal<ToolWrench, Frame, 6> {
  using Signal::Signal;
  static constexpr Quantity quantity{"tool wrench", "N·m, N"};
  static constexpr std::array<std::string_view, 6> elements{"mx", "my", "mz", "fx", "fy", "fz"};
};

/// How the orientation of a tool is held.
struct OrientationGains {
  Eigen::Vector3d stiffness = Eigen::Vector3d::Constant(15);  ///< K_ω, each ≥ 0 [N·m/rad]
  /// D_ω, each ≥ 0 [N·m·s/rad]. NS has none: there, the joints' friction damps the turn.
  Eigen::Vector3d damping = Eigen::Vector3d::Zero();

  template <class F>
  void Parameters(F&& f) {
    f("stiffness", stiffness, "N·m/rad", kNotNegative);
    f("damping", damping, "N·m·s/rad", kNotNegative);
  }
};

/// A wrench that moves a tool, and the torques that make it:
///
///   e_r = log(R_d Rᵀ),   F_ω = K_ω e_r − D_ω (ω − ω_d)                                  (NS 7)
///   τᶜ = Jᵀ [F_ω; F_v]                                                                  (NS 8)
///
/// Gains are diagonal, in world axes. The turn is the shorter one, so F_ω changes sign at half a
/// turn, where both are as short; ‖F_ω‖ is at most π times the largest stiffness without D_ω. With
/// K_ω = k I, F_ω does the work −d/dt ½ k ‖e_r‖² up to half a turn; with three different gains that
/// holds for small turns only.
class ToolImpedance : public Block {
 public:
  Input<FrameDynamics> frame{this, "frame"};                     ///< of the tool
  Input<Pose> target{this, "target"};                            ///< R_d
  Input<Twist> target_twist{this, "target_twist", {}, Twist{}};  ///< ω_d; 0 if not connected
  Output<OrientationError> orientation_error{this, "orientation_error"};
  Output<ToolWrench> wrench{this, "wrench"};  ///< [F_ω; F_v]
  Output<JointTorque> torque;                 ///< τᶜ

 protected:
  ToolImpedance(const Joints& joints, const OrientationGains& orientation);
  ToolWrench Pull(const FrameDynamics& now, const OrientationError& e_r, const Twist& target_twist,
                  const Eigen::Vector3d& F_v) const;

 private:
  const OrientationGains orientation_;
};

/// Cartesian impedance without a spring in the position: where the tool is led, it stays compliant.
///
///   F_v = D ṗ_c                                                                         (NS 6)
///
/// Of a free mass m with ṗ_c = k_p (v_d − v) it makes m v̇ = D k_p (v_d − v).
///
/// Source: Yang, Wang & Kermani 2025 (NS).
class VelocityImpedance final : public ToolImpedance {
 public:
  struct Options {
    Joints joints;
    Eigen::Vector3d damping = Eigen::Vector3d(40, 40, 10);  ///< D, each ≥ 0 [N·s/m]
    OrientationGains orientation = {};
  };

  explicit VelocityImpedance(const Options& o);

  Input<LinearVelocity> command{this, "command"};  ///< ṗ_c

 private:
  ToolWrench Act(const FrameDynamics& now, const OrientationError& e_r, const Twist& target_twist,
                 const LinearVelocity& command) const;

  const Eigen::Vector3d D_;
};

/// Cartesian impedance about a point that moves in time:
///
///   F_v = K_c (p_d − p) + D_c (ṗ_d − ṗ)
///
/// Source: Hogan, ASME J. Dynamic Systems, Measurement and Control 107, 1985, as NS compares it.
class ClassicalImpedance final : public ToolImpedance {
 public:
  struct Options {
    Joints joints;
    Eigen::Vector3d stiffness = Eigen::Vector3d::Constant(30);  ///< K_c, each ≥ 0 [N/m]
    Eigen::Vector3d damping = Eigen::Vector3d(40, 40, 10);      ///< D_c, each ≥ 0 [N·s/m]
    OrientationGains orientation = {};
  };

  explicit ClassicalImpedance(const Options& o);

 private:
  ToolWrench Act(const FrameDynamics& now, const OrientationError& e_r, const Pose& target,
                 const Twist& target_twist) const;

  const Eigen::Vector3d K_, D_;
};

}  // namespace pliant
