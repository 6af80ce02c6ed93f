#pragma once

#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Where a frame is to be, how fast and with what acceleration.
struct PoseMotion {
  Pose pose;           ///< X_W°
  Twist twist;         ///< V° = [ω; v], world axes
  Twist acceleration;  ///< V̇°

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("pose", pose, "");
    f("twist", twist, "");
    f("acceleration", acceleration, "");
  }
};

/// What a FrameTask follows: target, target_twist and target_acceleration.
class PoseReference : public Block {
 public:
  Output<Pose> pose{this, "pose"};
  Output<Twist> twist{this, "twist"};
  Output<Twist> acceleration{this, "acceleration"};

 protected:
  PoseReference();
  Output<PoseMotion> motion_{this, "motion"};
};

/// Goes from waypoint to waypoint with least jerk, and rests at each: between two of them, at t₀
/// and t₁, with x = (t − t₀)/(t₁ − t₀),
///
///   s = 10 x³ − 15 x⁴ + 6 x⁵
///   p = p₀ + s (p₁ − p₀),   R = exp(s φ) R₀,   φ = log(R₁ R₀ᵀ)
///   V° = ṡ [φ; p₁ − p₀],   V̇° = s̈ [φ; p₁ − p₀]
///
/// Before the first and after the last it stands still. Neighbours are less than half a turn apart.
/// Source: Flash & Hogan, J. Neuroscience 5(7), 1985.
class PoseWaypoints final : public PoseReference {
 public:
  struct Waypoint {
    double time_s;
    Pose pose;
  };
  struct Options {
    std::vector<Waypoint> waypoints;  ///< at least one, in order of time
  };

  explicit PoseWaypoints(const Options& o);

 private:
  PoseMotion At(double t) const;

  const std::vector<Waypoint> waypoints_;
};

/// Moves to and fro between a pose and one beyond it, from rest:
///
///   s = ½ (1 − cos 2π f (t − t₀)),   t ≥ t₀
///   p = p₀ + s d,   R = exp(s φ) R₀
///
class PoseSwing final : public PoseReference {
 public:
  struct Options {
    Pose start;                                      ///< X_W at s = 0
    Eigen::Vector3d way = Eigen::Vector3d::Zero();   ///< d, world axes [m]
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< φ, axis times angle, world axes [rad]
    double frequency_hz;                             ///< f > 0
    double start_s = 0;                              ///< t₀
  };

  explicit PoseSwing(const Options& o);

 private:
  PoseMotion At(double t) const;

  const Options o_;
};

/// Goes round a circle through the pose it starts at, with its orientation unchanged:
///
///   p = c + (p₀ − c) cos θ + (n × (p₀ − c)) sin θ
///
/// θ̇ rises to ω over T, with x = (t − t₀)/T, as 10 x³ − 15 x⁴ + 6 x⁵, and stays there.
class PoseCircle final : public PoseReference {
 public:
  struct Options {
    Pose start;              ///< X_W at θ = 0
    Eigen::Vector3d center;  ///< c [m]
    Eigen::Vector3d normal;  ///< n, of any length, perpendicular to p₀ − c
    double speed;            ///< ω [rad/s], its sign by the right-hand rule about n
    double rise_s = 1;       ///< T > 0
    double start_s = 0;      ///< t₀
  };

  explicit PoseCircle(const Options& o);

 private:
  PoseMotion At(double t) const;

  const Options o_;
  const Eigen::Vector3d radius_, normal_;  // p₀ − c, n
};

}  // namespace pliant
