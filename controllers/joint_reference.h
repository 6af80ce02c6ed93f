#pragma once

#include <vector>

#include "pliant/controllers/path_phase.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Where the joints are to be, how fast and with what acceleration.
struct JointMotion {
  using Space = Joints;
  static constexpr Quantity quantity{"joint motion", ""};

  JointPosition position;
  JointVelocity velocity;
  JointAcceleration acceleration;

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("position", position, "rad");
    f("velocity", velocity, "rad/s");
    f("acceleration", acceleration, "rad/s²");
  }
};

/// What a PostureTask follows: target, target_velocity and target_acceleration. A path q(φ) in
/// time:
///
///   q̇° = q_φ φ̇,   q̈° = q_φφ φ̇² + q_φ φ̈        φ = t where no phase is connected
///
class JointReference : public Block {
 public:
  Input<PathTime> phase;  ///< φ, such as PathPhase gives it
  Output<JointPosition> position;
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;

 protected:
  JointReference(const Joints& joints, const JointPosition& start);
  Output<JointMotion> motion_;
};

/// Goes from waypoint to waypoint with least jerk, and rests at each, as PoseWaypoints does:
///
///   q = q₀ + s (q₁ − q₀),   s = 10 x³ − 15 x⁴ + 6 x⁵,   x = (t − t₀)/(t₁ − t₀)
///
/// Continuous joints go the way the numbers say, which may be more than a turn.
class JointWaypoints final : public JointReference {
 public:
  struct Waypoint {
    double time_s = kToBeGiven;
    JointPosition position = {};  ///< [rad]

    template <class F>
    void Parameters(F&& f) {
      f("time_s", time_s, "s");
      f("position", position, "rad");
    }
  };
  struct Options {
    static constexpr const char* kTag = "JointWaypoints";

    Joints joints;
    std::vector<Waypoint> waypoints;  ///< at least one, in order of time

    template <class F>
    void Parameters(F&& f) {
      f("waypoints", waypoints);
    }
  };

  explicit JointWaypoints(const Options& o);

 private:
  JointMotion Move(double t, const PathTime& phase) const;

  const std::vector<Waypoint> waypoints_;
};

/// Moves to and fro between a posture and one beyond it, from rest:
///
///   q = q₀ + ½ (1 − cos 2π f (t − t₀)) d,   t ≥ t₀
///
class JointSwing final : public JointReference {
 public:
  struct Options {
    static constexpr const char* kTag = "JointSwing";

    Joints joints;
    JointPosition start = {};          ///< q₀ [rad]
    PerJoint way = {};                 ///< d [rad]
    double frequency_hz = kToBeGiven;  ///< f > 0
    double start_s = 0;                ///< t₀

    template <class F>
    void Parameters(F&& f) {
      f("start", start, "rad");
      f("way", way, "rad");
      f("frequency_hz", frequency_hz, "Hz", kPositive);
      f("start_s", start_s, "s");
    }
  };

  explicit JointSwing(const Options& o);

 private:
  JointMotion Move(double t, const PathTime& phase) const;

  const Options o_;
};

}  // namespace pliant
