#pragma once

#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// An unmoving plane that a spherical tip of a link presses into and slides on: a table top, a
/// wall.
///
///   N = max(0, k p (1 + c ṗ))  where p > 0,   N = 0  where not    (hunt_crossley.h)
///   F = N n − μ N v_t / √(v_tᵀ v_t + v_s²)
///
/// p: how far the contact point, the deepest point of the tip, lies below the plane; v: the
/// velocity of the link there; ṗ = −nᵀ v, v_t = v + ṗ n. F acts at the contact point. The
/// integrator stops where the tip comes down, p = 0; F has no jump there.
///
/// Friction is Coulomb's law, regularised: at v_s it has 71 % of μ N, at 10 v_s 99.5 %. So nothing
/// sticks for ever: a steady tangential force f < μ N makes the tip creep with
///
///   v = v_s f / √((μ N)² − f²)
///
/// Energy: E = ½ k p² is stored, and dissipation = (N − k p) ṗ + μ N v_tᵀ v_t/√(v_tᵀ v_t + v_s²).
///
/// Assumes: one contact, small p against the radius; no friction against spinning or rolling. With
/// v_s too small the problem is stiff: μ N/(m v_s) is a rate.
class Surface final : public Block {
 public:
  struct Options {
    static constexpr const char* kTag = "Surface";

    RobotModel model;
    std::string link;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< centre of the tip, in the link [m]
    double radius = 0;                                  ///< of the tip [m], ≥ 0
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< a point of the plane, in the world [m]
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< n, to the free side, of any length
    double stiffness = kToBeGiven;                      ///< k [N/m], > 0
    double damping = 0;                                 ///< c [s/m], ≥ 0
    double friction = 0;                                ///< μ, ≥ 0
    double slip_speed = 1e-3;                           ///< v_s [m/s], > 0

    template <class F>
    void Parameters(F&& f) {
      f("link", link);
      f("point", point, "m");
      f("radius", radius, "m", kNotNegative);
      f("origin", origin, "m");
      f("normal", normal);
      f("stiffness", stiffness, "N/m", kPositive);
      f("damping", damping, "s/m", kNotNegative);
      f("friction", friction, "", kNotNegative);
      f("slip_speed", slip_speed, "m/s", kPositive);
    }
  };

  explicit Surface(const Options& o);

  Input<RobotDynamics> motion;  ///< of the plant
  Output<ContactForce> contact;
  Output<double> penetration;   ///< p [m]; below zero: the distance
  Output<double> normal_force;  ///< N [N]
  Output<bool> touching;
  Output<int> touches;         ///< how often the tip has come down on the plane
  Output<double> energy;       ///< ½ k p² (p > 0) [J]
  Output<double> dissipation;  ///< [W]

 private:
  struct Touch {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in the link's frame
    Eigen::Vector3d v_t = Eigen::Vector3d::Zero();
    double p = 0, p_dot = 0;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("point", point, "m");
      f("v_t", v_t, "m/s");
      f("p", p, "m");
      f("p_dot", p_dot, "m/s");
    }
  };

  Touch Meet(const RobotDynamics& d) const;
  double Press(const Touch& touch) const;
  Eigen::Vector3d Rub(const double& N, const Touch& touch) const;
  ContactForce Act(const double& N, const Touch& touch) const;
  double Store(const double& p) const;
  double Dissipate(const double& N, const Touch& touch) const;

  const RobotModel model_;
  const int link_;
  const Eigen::Vector3d point_, origin_, n_;
  const double radius_, k_, c_, mu_, v_s_;
  Discrete<int> touches_;
  Output<Touch> touch_;
};

}  // namespace pliant
