#pragma once

#include <numbers>
#include <optional>

#include "pliant/controllers/objective.h"
#include "pliant/controllers/pose_reference.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// How a virtual door stands and what moves it: I θ̈ = τ_e + τ_p − τ_f.
struct DoorMotion {
  using Space = Nothing;
  static constexpr Quantity quantity{"door motion", "rad"};

  double angle = 0;         ///< θ [rad]
  double rate = 0;          ///< θ̇ [rad/s]
  double acceleration = 0;  ///< θ̈ [rad/s²]
  double external = 0;      ///< τ_e = sᵀ F̂, about the hinge [N·m]
  double passive = 0;       ///< τ_p, of closer, weight, viscous friction and stops [N·m]
  double friction = 0;      ///< τ_f [N·m]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("angle", angle, "rad");
    f("rate", rate, "rad/s");
    f("acceleration", acceleration, "rad/s²");
    f("external", external, "N·m");
    f("passive", passive, "N·m");
    f("friction", friction, "N·m");
  }
};

/// Where a door is stopped, by the law of hunt_crossley.h with an angle for the depth.
struct DoorStops {
  double lower = kToBeGiven, upper = kToBeGiven;  ///< θ [rad]
  double stiffness = kToBeGiven;                  ///< [N·m/rad]
  double damping = 0;                             ///< [s/rad]

  template <class F>
  void Parameters(F&& f) {
    f("lower", lower, "rad", Between(-std::numbers::pi, std::numbers::pi));
    f("upper", upper, "rad", Between(-std::numbers::pi, std::numbers::pi));
    f("stiffness", stiffness, "N·m/rad", kPositive);
    f("damping", damping, "s/rad", kNotNegative);
  }
};

/// Makes a tool behave like the handle of a door: free to turn about a hinge with an inertia of
/// its own choice, stiff in the five other directions.
///
///   task.frame ─▶ door ─▶ pose, twist, acceleration, mobility ─▶ task
///   q̈_e ───────▶ door
///
/// The hinge goes through the point h along n. X₀ is the pose of the tool with the door closed,
/// r₀ ⊥ n the way to it from the hinge, r that to the tool as it is. The door's angle is found from
/// the tool's position, its rate from its velocity v,
///
///   θ = atan2(n · (r₀ × r), r₀ · r),   θ̇ = (n × r) · v / ‖r‖²
///
/// and what the task follows is the handle at that angle, p° = h + exp(θ n)(p₀ − h):
///
///   R° = exp(θ n) R₀,   V° = s θ̇,   V̇° = s θ̈_p + ṡ θ̇,   s = [n; n × (p° − h)]
///   Y = s sᵀ/I,   I θ̈_p = τ_p − τ_f
///   τ_p = −k (θ − θ₀) + n · ((c − h) × m γ) − b θ̇ + stops,   c = h + exp(θ n)(c₀ − h)
///
/// Then a FrameTask with Γ = Y Λ makes of what pushes, F̂ = Λ J q̈_e, the rest: with e = 0, ė = 0,
///
///   V̇ = V̇° + Y F̂ = s (θ̈_p + sᵀF̂/I) + ṡ θ̇   ⇒   I θ̈ = sᵀF̂ + τ_p − τ_f
///
/// Of an e that is not 0 the feedback sees nothing along the circle: p − p° ⊥ n × r, so neither
/// stiffness nor a lag of the orientation, which turns after the position, adds to I. ė has a
/// part along the circle, θ̇ times the error of the radius, which is 0 where the task is followed.
///
/// Friction is Coulomb's, c, made to stop within T: of all torques up to c that which comes closest
/// to θ̈ = −θ̇/T,
///
///   τ_f = clamp(I θ̇/T + τ_e + τ_p, ±c)
///
/// It opposes motion with c where |θ̇| > T (c + |τ_e + τ_p|)/I, and it holds: where |τ_e + τ_p| ≤ c
/// and θ̇ is small, θ̇ falls as e^{−t/T} and the door stays. T is longer than a period of control;
/// then this is the implicit rule for c sgn(θ̇) with a step of T. A door that is held has no memory
/// of where: an error ε of τ̂_e moves it at T ε/I.
///
/// Both ways of F̂, through Y and through τ_e, must be the same for the door to be held: FrameForce
/// and the task have one limit of inertia.
///
/// θ lies within half a turn of closed. The tool must not come near the hinge's axis.
/// Source: Celerier et al. 2025 (EC), virtual inertia and the demonstration of a door.
class VirtualDoor final : public Block {
 public:
  using Stops = DoorStops;

  struct Options {
    static constexpr const char* kTag = "VirtualDoor";

    Joints joints;
    Pose closed;                              ///< X₀, of the tool at θ = 0
    Eigen::Vector3d gravity{0, 0, -9.80665};  ///< γ [m/s²]

    Eigen::Vector3d hinge = Eigen::Vector3d::Constant(kToBeGiven);  ///< h, world [m]
    Eigen::Vector3d axis = Eigen::Vector3d::Constant(kToBeGiven);   ///< n, of any length, world
    double inertia = kToBeGiven;                       ///< I, about the hinge [kg·m²]
    double closer = 0;                                 ///< k [N·m/rad]
    double rest_angle = 0;                             ///< θ₀ [rad]
    double mass = 0;                                   ///< m, whose weight acts [kg]
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< c₀, of m at θ = 0, world [m]
    double viscous = 0;                                ///< b [N·m·s/rad]
    double coulomb = 0;                                ///< c [N·m]
    double stopping_time = 0.01;                       ///< T [s]
    double inertia_limit = 200;  ///< of FrameForce, as that of the task [kg, kg·m²]
    std::optional<Stops> stops = {};

    template <class F>
    void Parameters(F&& f) {
      f("hinge", hinge, "m");
      f("axis", axis);
      f("inertia", inertia, "kg·m²", kPositive);
      f("closer", closer, "N·m/rad", kNotNegative);
      f("rest_angle", rest_angle, "rad", Between(-std::numbers::pi, std::numbers::pi));
      f("mass", mass, "kg", kNotNegative);
      f("center", center, "m");
      f("viscous", viscous, "N·m·s/rad", kNotNegative);
      f("coulomb", coulomb, "N·m", kNotNegative);
      f("stopping_time", stopping_time, "s", kPositive);
      f("inertia_limit", inertia_limit, "kg", kPositive);
      f("stops", stops);
    }
  };

  explicit VirtualDoor(const Options& o);

  Input<FrameDynamics> frame;  ///< of the tool, as FrameTask shows it
  Input<RobotDynamics> dynamics;
  Input<JointAcceleration> external_acceleration;  ///< q̈_e; 0 if not connected
  Output<TaskMatrix> mobility;                     ///< Y, 6×6 [1/(kg·m²), 1/(kg·m), 1/kg]
  Output<DoorMotion> door;

  /// What the task follows: target, target_twist and target_acceleration.
  Output<Pose> pose;
  Output<Twist> twist, acceleration;

 private:
  DoorMotion Swing(const FrameDynamics& tool, const RobotDynamics& d,
                   const JointAcceleration& qdd_e) const;
  PoseMotion Handle(const DoorMotion& now) const;
  TaskMatrix Mobility(const DoorMotion& now) const;
  double Passive(double theta, double rate) const;
  Eigen::Vector3d Turned(double theta, const Eigen::Vector3d& point) const;
  Vector6 Screw(double theta) const;

  const Options o_;
  const Eigen::Vector3d n_, u_, w_;  // u along r₀, w = n × u
  Output<PoseMotion> handle_;
};

}  // namespace pliant
