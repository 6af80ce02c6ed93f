#pragma once

#include <string>

#include "pliant/plants/robot_dynamics.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// A point mass on an elastic rope that is tied to a point a of a link: hanging, it is a pendulum;
/// dropped, it falls freely until the rope catches it.
///
///   ẋ = v,   m v̇ = m γ − T u,   F = T u at a
///
///   r = x − a,   u = r/‖r‖,   δ = ‖r‖ − L,   δ̇ = uᵀ (v − ȧ)
///
///   T = max(0, k δ + d δ̇)  where δ > 0,   T = 0  where not
///
/// A rope pulls and never pushes. It is taut where k δ + d min(0, δ̇) > 0; the integrator stops at
/// both ends of that, so that the blow d δ̇ of a damped rope begins when it begins. `catches` counts
/// how often a slack rope became taut.
///
/// Until `release` the mass is held in place; then it leaves with `velocity`.
///
/// Energy is never made: the rope takes (v − ȧ)ᵀ u T = T δ̇ and stores ½ k δ² of it (δ > 0), so
///
///   dissipation = T δ̇ − k δ δ̇ = d δ̇² ≥ 0    where it pulls,
///                             = −k δ δ̇ ≥ 0   where k δ + d δ̇ ≤ 0 < δ, that is δ̇ ≤ −k δ/d ≤ 0,
///
/// and 0 where δ ≤ 0. The second line is a rope that shrinks more slowly than its ends come closer.
/// Before the release, whoever holds the mass does no work on it; a `velocity` that it gets then is
/// given to it.
///
/// Assumes: a rope without mass, straight between its ends; γ is the model's gravity.
class MassOnRope final : public Block {
 public:
  struct Options {
    static constexpr const char* kTag = "MassOnRope";

    RobotModel model;
    std::string link;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< a, in the link's frame [m]
    double mass = kToBeGiven;                         ///< m [kg], > 0
    double length = kToBeGiven;                       ///< L, unstretched [m], > 0
    double stiffness = kToBeGiven;                    ///< k [N/m], > 0
    double damping = 0;                               ///< d [N·s/m], ≥ 0
    /// x at the start, in the world [m]
    Eigen::Vector3d position = Eigen::Vector3d::Constant(kToBeGiven);
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< v at the release [m/s]
    Duration release = {};                               ///< ≥ 0

    template <class F>
    void Parameters(F&& f) {
      f("link", link);
      f("point", point, "m");
      f("mass", mass, "kg", kPositive);
      f("length", length, "m", kPositive);
      f("stiffness", stiffness, "N/m", kPositive);
      f("damping", damping, "N·s/m", kNotNegative);
      f("position", position, "m");
      f("velocity", velocity, "m/s");
      f("release", release);
    }
  };

  explicit MassOnRope(const Options& o);

  Input<RobotDynamics> motion;      ///< of the plant
  Output<ContactForce> contact;     ///< F
  Output<Position> position;        ///< x
  Output<LinearVelocity> velocity;  ///< v; zero before the release
  Output<double> tension;           ///< T [N]
  Output<bool> taut;
  Output<int> catches;
  Output<double> energy;       ///< ½ k δ² (δ > 0) + ½ m vᵀ v − m γᵀ x [J]
  Output<double> dissipation;  ///< of the rope [W]

 private:
  struct Rope {
    Eigen::Vector3d u = Eigen::Vector3d::Zero();  // from the link to the mass
    double delta = 0, delta_dot = 0;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("u", u, "");
      f("delta", delta, "m");
      f("delta_dot", delta_dot, "m/s");
    }
  };

  Rope Span(const Position& x, const LinearVelocity& v, const RobotDynamics& d) const;
  bool StartsTaut(const Rope& rope) const;
  double Grip(const bool& taut, const Rope& rope) const;
  double Pull(const bool& taut, const Rope& rope) const;
  LinearAcceleration Accelerate(const bool& released, const double& T, const Rope& rope) const;
  ContactForce Act(const double& T, const Rope& rope) const;
  double Store(const Rope& rope, const Position& x, const LinearVelocity& v) const;
  double Dissipate(const double& T, const Rope& rope) const;

  const RobotModel model_;
  const int link_;
  const Eigen::Vector3d point_;
  const double m_, L_, k_, d_;
  Continuous<Position> x_;
  Continuous<LinearVelocity> v_;
  Discrete<bool> taut_;
  Discrete<int> catches_;
  Output<bool> released_;
  Output<Rope> rope_;
  Output<double> grip_;  // k δ + d min(0, δ̇), never 0
  Output<double> T_;     // of the phase: not below 0 but by round-off, and while it is looked ahead
};

}  // namespace pliant
