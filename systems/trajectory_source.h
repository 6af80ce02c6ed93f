#pragma once

#include <string>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/joint_trajectory.h"

namespace pliant {

/// What goes on between the rows of a trajectory.
enum class Interpolation {
  Hold,      ///< the row before
  Linear,    ///< velocities jump at rows
  Cubic,     ///< natural spline: accelerations do not jump, and are zero at both ends
  Monotone,  ///< cubics that do not overshoot: velocities do not jump, accelerations do
};
const std::vector<std::string>& Words(Interpolation);

/// What comes behind the last row.
enum class TrajectoryEnd {
  Hold,  ///< the last position, at rest
  Stop,  ///< the run ends there
};
const std::vector<std::string>& Words(TrajectoryEnd);

/// Plays a trajectory of joints:
///
///   q(t),  v(t) = q̇,  a(t) = q̈     between its rows as `interpolation` says
///
/// Before the first row and after the last the joints rest there. A velocity or acceleration that
/// jumps at a row has its new value there.
///
///   b.Add<TrajectorySource>("wanted", {.trajectory = ReadJointTrajectory("way.csv", joints),
///                                      .interpolation = Interpolation::Cubic});
///
/// Sources: de Boor, A Practical Guide to Splines, 1978, ch. IV (natural spline); Fritsch &
/// Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300, with weights by the lengths (monotone).
class TrajectorySource final : public Block {
 public:
  struct Options {
    JointTrajectory trajectory;
    Interpolation interpolation = Interpolation::Linear;
    TrajectoryEnd end = TrajectoryEnd::Hold;
    double start_s = 0;  ///< when the trajectory's time is 0
  };

  explicit TrajectorySource(const Options& o);

  Output<JointPosition> position;
  Output<JointVelocity> velocity;
  Output<JointAcceleration> acceleration;
  Output<double> left;  ///< until the last row [s]; negative behind it

 private:
  /// Of one instant, computed once.
  struct Point {
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

  Point At(double t) const;
  double Left(double t) const;

  const std::vector<double> times_;
  const std::vector<JointPosition> positions_;
  const std::vector<JointVelocity> slopes_;  // at the rows, of cubics
  const Interpolation interpolation_;
  const double start_;
  Output<Point> point_;
};

}  // namespace pliant
