#pragma once

#include <vector>

#include "pliant/controllers/path_phase.h"
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

/// What a FrameTask follows: target, target_twist and target_acceleration. A path X(φ) in time:
///
///   V° = V_φ φ̇,   V̇° = V_φφ φ̇² + V_φ φ̈        φ = t where no phase is connected
///
class PoseReference : public Block {
 public:
  Input<PathTime> phase{this, "phase", {}, PathTime{}};  ///< φ, such as PathPhase gives it
  Output<Pose> pose{this, "pose"};
  Output<Twist> twist{this, "twist"};
  Output<Twist> acceleration{this, "acceleration"};

 protected:
  PoseReference();
  /// `path` at φ, with its rates with respect to φ made those with respect to time.
  template <class Path>
  static PoseMotion InTime(double t, const PathTime& phase, const Path& path);
  Output<PoseMotion> motion_{this, "motion"};
};

/// A pose and when it is to be reached.
struct TimedPose {
  double time_s = kToBeGiven;
  Pose pose;

  template <class F>
  void Parameters(F&& f) {
    f("time_s", time_s, "s");
    f("position", pose.position, "m");
    f("rotation", pose.rotation);
  }
};

/// Goes from waypoint to waypoint with least jerk, and rests at each: between two of them, at t₀
/// and t₁, with x = (t − t₀)/(t₁ − t₀),
///
///   s = 10 x³ − 15 x⁴ + 6 x⁵
///   p = p₀ + s (p₁ − p₀),   R = exp(s φ) R₀,   φ = log(R₁ R₀ᵀ)
///   V° = ṡ [φ; p₁ − p₀],   V̇° = s̈ [φ; p₁ − p₀]
///
/// Before the first and after the last it stands still. Neighbours are less than half a turn apart.
/// With `laps` it goes through all of them again and again, from the last on as from the first.
/// Source: Flash & Hogan, J. Neuroscience 5(7), 1985.
class PoseWaypoints final : public PoseReference {
 public:
  using Waypoint = TimedPose;
  struct Options {
    static constexpr const char* kTag = "Waypoints";

    std::vector<Waypoint> waypoints;  ///< at least one, in order of time
    int laps = 1;                     ///< more than one: the last pose is the first

    template <class F>
    void Parameters(F&& f) {
      f("waypoints", waypoints);
      f("laps", laps, "", Between(1, 100'000));
    }
  };

  explicit PoseWaypoints(const Options& o);

 private:
  PoseMotion Move(double t, const PathTime& phase) const;
  PoseMotion At(double t) const;

  std::vector<Waypoint> waypoints_;
};

/// Passes through the rows of a table, and rests before the first and after the last. Between two
/// rows the position is the polynomial of degree five that has at both the velocities and
/// accelerations of the parabola through a row and its neighbours, zero at the ends:
///
///   ṗ_i = (h_i d_{i+1} + h_{i+1} d_i)/(h_i + h_{i+1}),   p̈_i = 2 (d_{i+1} − d_i)/(h_i + h_{i+1})
///   d_i = (p_i − p_{i−1})/h_i,   h_i = t_i − t_{i−1}
///
/// The quaternion of R is the same of the rows' quaternions, divided by its length. Position and
/// rotation are twice continuously differentiable. Neighbours are at most a quarter turn apart.
class PoseTable final : public PoseReference {
 public:
  struct Options {
    static constexpr const char* kTag = "Table";

    std::vector<TimedPose> rows;  ///< at least one, in order of time

    template <class F>
    void Parameters(F&& f) {
      f("rows", rows);
    }
  };

  explicit PoseTable(const Options& o);

 private:
  using Vector7 = Eigen::Matrix<double, 7, 1>;  // position and quaternion
  using Quintic = Eigen::Matrix<double, 7, 6>;  // coefficients of 1, t − t_i, …

  PoseMotion Move(double t, const PathTime& phase) const;
  PoseMotion At(double t) const;

  std::vector<double> times_;
  std::vector<Quintic> pieces_;  // the piece from each time on; at last, rest
};

/// Moves to and fro between a pose and one beyond it, from rest:
///
///   s = ½ (1 − cos 2π f (t − t₀)),   t ≥ t₀
///   p = p₀ + s d,   R = exp(s φ) R₀
///
class PoseSwing final : public PoseReference {
 public:
  struct Options {
    static constexpr const char* kTag = "Swing";

    Pose start;                                      ///< X_W at s = 0
    Eigen::Vector3d way = Eigen::Vector3d::Zero();   ///< d, world axes [m]
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< φ, axis times angle, world axes [rad]
    double frequency_hz = kToBeGiven;                ///< f > 0
    double start_s = 0;                              ///< t₀

    template <class F>
    void Parameters(F&& f) {
      f("position", start.position, "m");
      f("rotation", start.rotation);
      f("way", way, "m");
      f("turn", turn, "rad");
      f("frequency_hz", frequency_hz, "Hz", kPositive);
      f("start_s", start_s, "s");
    }
  };

  explicit PoseSwing(const Options& o);

 private:
  PoseMotion Move(double t, const PathTime& phase) const;
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
    static constexpr const char* kTag = "Circle";

    Pose start;                                                      ///< X_W at θ = 0
    Eigen::Vector3d center = Eigen::Vector3d::Constant(kToBeGiven);  ///< c [m]
    /// n, of any length, perpendicular to p₀ − c
    Eigen::Vector3d normal = Eigen::Vector3d::Constant(kToBeGiven);
    double speed = kToBeGiven;  ///< ω [rad/s], its sign by the right-hand rule about n
    double rise_s = 1;          ///< T > 0
    double start_s = 0;         ///< t₀

    template <class F>
    void Parameters(F&& f) {
      f("position", start.position, "m");
      f("rotation", start.rotation);
      f("center", center, "m");
      f("normal", normal);
      f("speed", speed, "rad/s");
      f("rise_s", rise_s, "s", kPositive);
      f("start_s", start_s, "s");
    }
  };

  explicit PoseCircle(const Options& o);

 private:
  PoseMotion Move(double t, const PathTime& phase) const;
  PoseMotion At(double t) const;

  const Options o_;
  const Eigen::Vector3d radius_, normal_;  // p₀ − c, n
};

}  // namespace pliant
