#pragma once

#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// A hand that holds a point x of a link by a spring and a damper, and leads it along a path:
///
///   F = g (K e + d ė),   e = x_h − x,   K = diag(k)
///
/// x_h is where the hand wants the point: `path` itself, or, `anchored`, the place where it took
/// hold and as far from there as the path has gone since,
///
///   x_h(t) = x(t₀) + path(t) − path(t₀)
///
/// t₀ is the last instant at which the grip g rose above 0, or the start. So a hand that takes hold
/// does it without a jerk. g is the firmness from 0, let go, to 1; what lies outside counts as the
/// nearer end. A Step, a Pulse or a Ramp makes it grip and let go.
///
/// Energy: with E = ½ g eᵀ K e and constant g,
///
///   ẋ_hᵀ F = ẋᵀ F + Ė + g d ‖ė‖²
///
/// the person gives `power`, the arm takes ẋᵀ F, and `dissipation` = g d ‖ė‖² ≥ 0. While g changes
/// the person gives ½ ġ eᵀ K e besides: what is stored when a hand lets go is lost in the hand.
///
/// Assumes: `path_velocity` is the rate of `path`; left at zero, the damper brakes the point
/// against the ground, and `power` leaves out what the moving spring does. A hand has no mass and
/// exerts no moment.
class Hand final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string link;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< x, in the link's frame [m]
    /// k, along the world's axes [N/m], each ≥ 0
    Eigen::Vector3d stiffness = Eigen::Vector3d::Constant(kToBeGiven);
    double damping = 0;     ///< d [N·s/m], ≥ 0
    bool anchored = false;  ///< to where it takes hold

    template <class F>
    void Parameters(F&& f) {
      f("link", link);
      f("point", point, "m");
      f("stiffness", stiffness, "N/m", kNotNegative);
      f("damping", damping, "N·s/m", kNotNegative);
    }
  };

  explicit Hand(const Options& o);

  Input<Position> path;                 ///< [m]; anchored: zero if not connected
  Input<LinearVelocity> path_velocity;  ///< zero if not connected
  Input<double> grip;                   ///< g; 1 if not connected
  Input<RobotDynamics> motion;          ///< of the plant
  Output<ContactForce> contact;
  Output<double> energy;       ///< ½ g eᵀ K e [J]
  Output<double> dissipation;  ///< g d ‖ė‖² [W]
  Output<double> power;        ///< ẋ_hᵀ F, what the person gives [W]

 private:
  struct Pull {
    double g = 0;
    Eigen::Vector3d e = Eigen::Vector3d::Zero();
    Eigen::Vector3d edot = Eigen::Vector3d::Zero();

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("g", g, "");
      f("e", e, "m");
      f("edot", edot, "m/s");
    }
  };

  Pull Stretch(const double& g, const Position& anchor, bool held, const Position& path,
               const LinearVelocity& path_velocity, const RobotDynamics& d) const;
  Position TakeHold(const Position& path, const RobotDynamics& d) const;
  ContactForce Act(const Pull& pull) const;
  double Store(const Pull& pull) const;
  double Dissipate(const Pull& pull) const;
  double Drive(const ContactForce& F, const LinearVelocity& path_velocity) const;

  const RobotModel model_;
  const int link_;
  const Eigen::Vector3d point_, k_;
  const double d_;
  Discrete<Position> anchor_;  // x(t₀) − path(t₀)
  Discrete<bool> held_;        // since t₀; until then, and once let go, there is no force
  Output<double> holds_;       // 1 or −1
  Output<Pull> pull_;
};

}  // namespace pliant
