#pragma once

#include <Eigen/Core>
#include <array>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/plants/robot_model.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// Largest number of frames of a RobotDynamics.
inline constexpr int kMaxFrames = 8;

/// [angular; linear] parts of a spatial vector.
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// How a frame moves, in world axes, at the frame's origin, angular part first:
///
///   V = J v,   d/dt V = J v̇ + J̇ v
///
/// The columns of J are the twists per unit of joint velocity; those of joints that do not carry
/// the frame are zero.
struct FrameDynamics {
  int link = -1;                     ///< index in the model
  Pose pose;                         ///< X_WF
  Twist twist;                       ///< V [rad/s, m/s]
  Jacobian J;                        ///< 6×n
  Vector6 Jdot_v = Vector6::Zero();  ///< J̇ v, the acceleration at v̇ = 0 [rad/s², m/s²]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("link", link, "");
    f("pose", pose, "");
    f("twist", twist, "rad/s, m/s");
    f("J", J, "");
    f("Jdot_v", Jdot_v, "rad/s², m/s²");
  }
};

/// How a body moves, in world axes, at the origin of its frame. Its joint turns about or slides
/// along the third column of `rotation`.
struct BodyMotion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< R_WB
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();         ///< angular velocity [rad/s]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero();  ///< angular acceleration at v̇ = 0 [rad/s²]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< at v̇ = 0, without gravity [m/s²]

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("rotation", rotation, "");
    f("position", position, "m");
    f("omega", omega, "rad/s");
    f("velocity", velocity, "m/s");
    f("alpha", alpha, "rad/s²");
    f("acceleration", acceleration, "m/s²");
  }
};

/// Everything controllers and observers ask of a robot model at one (q, v):
///
///   M v̇ + C v + g = τ + τ_e,   p = M v,   Ṁ = C + Cᵀ
///
/// n joints in the order of the model; M is n×n, the vectors have n elements. A plain value of
/// bounded size, made for a model and the links whose frames are wanted, and then only written in
/// place.
struct RobotDynamics {
  using Space = Joints;
  static constexpr Quantity quantity{"robot dynamics", ""};

  RobotDynamics() = default;
  RobotDynamics(const RobotModel& model, std::span<const std::string> names);
  RobotDynamics(const RobotModel& model, std::initializer_list<std::string> names = {})
      : RobotDynamics(model, std::span(names.begin(), names.size())) {}

  JointPosition q;                  ///< at which all this holds
  JointVelocity v;                  ///< at which all this holds
  JointMatrix M;                    ///< joint inertia, symmetric, positive definite [kg·m²]
  JointTorque coriolis;             ///< C v
  JointTorque coriolis_transposed;  ///< Cᵀ v = ∂(½ vᵀ M v)/∂q
  JointTorque gravity;              ///< g
  JointMomentum p;                  ///< M v

  std::array<FrameDynamics, kMaxFrames> frame;  ///< in the order they were asked for
  int frames = 0;                               ///< how many of them there are
  std::array<BodyMotion, kMaxJoints> body;      ///< of the bodies of the model

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("q", q, "rad");
    f("v", v, "rad/s");
    f("M", M, "kg·m²");
    f("coriolis", coriolis, "N·m");
    f("coriolis_transposed", coriolis_transposed, "N·m");
    f("gravity", gravity, "N·m");
    f("p", p, "N·m·s");
    const auto fields = [&f](std::string_view name, auto& all, auto count) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
        f(std::string(name) + std::to_string(i), all[i], "");
    };
    fields("frame_", frame, frames);
    fields("body_", body, q.size());
  }
};

/// Writes into `d` all it holds, at (q, v). No heap, no exceptions.
///
/// One sweep from the base to the tips (motions, inertias) and one back (Newton–Euler forces,
/// composite inertias I, momenta h), in world axes about the origin of each joint. With S_i the
/// twist of joint i:
///
///   M_ij = S_iᵀ I_j S_j,   (C v)_i = S_iᵀ f_i,   p_i = S_iᵀ h_i,   (Cᵀ v)_i = h_iᵀ (V_i × S_i)
///
/// Source: Featherstone, Rigid Body Dynamics Algorithms, 2008: tables 5.1 (Newton–Euler) and 6.2
/// (composite inertias). The last one: at v̇ = 0, C v + Cᵀ v = Ṁ v = ṗ, and the rate of S_iᵀ h_i is
/// S_iᵀ f_i + h_iᵀ (V_i × S_i).
void ComputeDynamics(const RobotModel& model, const JointPosition& q, const JointVelocity& v,
                     RobotDynamics& d);

/// v̇ = (M + diag(B))⁻¹ (τ + τ_e − C v − g), by M + B = L Lᵀ. B is the reflected rotor inertia of
/// each joint [kg·m²]; empty: none. Not a number where M + diag(B) is not positive definite.
JointAcceleration ForwardDynamics(const RobotDynamics& d, const JointTorque& tau,
                                  const JointTorque& tau_e, const PerJoint& rotor_inertia = {});

/// τ = M v̇ + C v + g.
JointTorque InverseDynamics(const RobotDynamics& d, const JointAcceleration& vdot);

/// τ_e = Σ Jᵀ F, of the forces of the environment on the links. Forces without a link (−1) are
/// skipped; a link the model does not have makes it NaN.
JointTorque ExternalTorque(const RobotModel& model, const RobotDynamics& d,
                           std::span<const ContactForce> forces);

/// X_WL of any link.
Pose LinkPose(const RobotModel& model, const RobotDynamics& d, int link);

/// What FrameDynamics says, for any point of any link: `point` in the link's frame [m], the results
/// in world axes. The frame at the point is parallel to the link's.
FrameDynamics PointDynamics(const RobotModel& model, const RobotDynamics& d, int link,
                            const Eigen::Vector3d& point);

/// Where a point of a link is and how it moves, in the world.
struct PointMotion {
  Eigen::Vector3d position;  ///< [m]
  Eigen::Vector3d velocity;  ///< [m/s]
};

/// `point` in the link's frame [m].
PointMotion MotionOf(const RobotModel& model, const RobotDynamics& d, int link,
                     const Eigen::Vector3d& point);

/// ½ vᵀ M v [J].
double KineticEnergy(const RobotDynamics& d);

/// −Σ m γᵀ c, with γ the model's gravity: zero with every centre of mass at the world's origin [J].
/// g = ∂U/∂q.
double PotentialEnergy(const RobotModel& model, const RobotDynamics& d);

}  // namespace pliant
