#pragma once

#include "pliant/controllers/contact_anchor.h"
#include "pliant/controllers/contact_inertia.h"
#include "pliant/systems/block.h"

namespace pliant {

/// A touched point moves as a mass on a spring and a damper does that the force F̂ pushes,
///
///   M_d (ẍ_c − ẍ_d) + K_d (ẋ_c − ẋ_d) + K_p (x_c − x_d) = F̂                              (CF 20)
///
/// as a term of three rows for what solves for the joint accelerations:
///
///   J_c q̈ = ẍ_d + M_d⁻¹ (K_d ė + K_p e + F̂) − J̇_c q̇,   e = x_d − x_c                   (CF 21)
///
/// x_d is where the point was when contact began, and as far from there as `displacement` says. The
/// term has its weight from the touch on, also after the release, so that the point returns;
/// without a point, 0. F̂ is the force of the environment on the arm. Along each axis of a diagonal
/// M_d
///
///   ω_n = √(k_p/m_d),   ζ = k_d/(2 √(k_p m_d)),   at rest e = −F̂/k_p                  (CF 13, 15)
///
/// With the natural inertia of a single contact what is commanded does not depend on F̂ (CF 24). Of
/// several contacts each has its own, so that they move apart from one another, and that takes F̂.
/// An M_d far below the natural inertia multiplies F̂ and its errors by their ratio, less one.
///
/// Source: Magrini, Flacco & De Luca 2015 (CF), IV-A.
class ContactImpedance final : public Block {
 public:
  struct Gains {
    static constexpr const char* kTag = "Impedance";

    TaskMatrix inertia = {};  ///< M_d, as ContactInertia has it; empty: the natural one
    /// K_d [N·s/m], a number, a diagonal or a matrix, ⪰ 0
    TaskMatrix damping = TaskMatrix::Constant(1, 1, 80);
    TaskMatrix stiffness = TaskMatrix::Constant(1, 1, 500);  ///< K_p [N/m], the same way

    template <class F>
    void Parameters(F&& f) {
      f("inertia", inertia);
      f("damping", damping);
      f("stiffness", stiffness);
    }
  };
  struct Options {
    RobotModel model;
    Gains gains;
    double weight = 1;  ///< of the term, > 0
  };

  explicit ContactImpedance(const Options& o);

  Input<AnchoredContact> contact;
  Input<RobotDynamics> dynamics;
  Input<Position> displacement;  ///< of x_d from the anchor; 0 if not connected
  Input<LinearVelocity> displacement_velocity;
  Input<LinearAcceleration> displacement_acceleration;
  Output<Position> error;  ///< e; 0 without a point
  Output<Objective> objective;

 private:
  Position Error(const AnchoredContact& c, const RobotDynamics& d, const Position& moved) const;
  void Want(Objective& out, const AnchoredContact& c, const RobotDynamics& d, const Position& e,
            const LinearVelocity& xdot_d, const LinearAcceleration& xddot_d) const;

  const RobotModel model_;
  const ContactInertia inertia_;
  const Eigen::Matrix3d K_d_, K_p_;
  const double weight_;
};

}  // namespace pliant
