#include "pliant/systems/trajectory_source.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

const JointTrajectory& Checked(const JointTrajectory& trajectory) {
  RequireTrajectory(trajectory);
  return trajectory;
}

/// Mean slope of each interval.
std::vector<JointVelocity> Chords(const JointTrajectory& t) {
  std::vector<JointVelocity> chords;
  for (std::size_t i = 0; i + 1 < t.times.size(); ++i)
    chords.emplace_back((t.positions[i + 1] - t.positions[i]) / (t.times[i + 1] - t.times[i]));
  return chords;
}

/// The slopes m of the natural spline, with intervals h and chords d:
///
///   2 m₀ + m₁ = 3 d₀,   h_i m_{i−1} + 2 (h_{i−1} + h_i) m_i + h_{i−1} m_{i+1} =
///   3 (h_i d_{i−1} + h_{i−1} d_i),   m_{n−1} + 2 m_n = 3 d_{n−1}
///
/// by elimination, which is stable since the diagonal dominates.
std::vector<JointVelocity> NaturalSlopes(const JointTrajectory& t) {
  const std::vector<JointVelocity> d = Chords(t);
  const std::size_t n = d.size();
  std::vector<JointVelocity> m(n + 1);
  std::vector<double> above(n + 1, 0);
  m[0] = 1.5 * d[0];
  above[0] = 0.5;
  for (std::size_t i = 1; i < n; ++i) {
    const double before = t.times[i] - t.times[i - 1], after = t.times[i + 1] - t.times[i];
    const double pivot = 2 * (before + after) - after * above[i - 1];
    m[i] = (3 * (after * d[i - 1] + before * d[i]) - after * m[i - 1]) / pivot;
    above[i] = before / pivot;
  }
  m[n] = (3 * d[n - 1] - m[n - 1]) / (2 - above[n - 1]);
  for (std::size_t i = n; i-- > 0;) m[i] -= above[i] * m[i + 1];
  return m;
}

/// Of one joint at a row within: the harmonic mean of the chords on both sides, by lengths, and
/// zero where they have not one sign.
double MonotoneSlope(double before, double after, double d0, double d1) {
  if (d0 * d1 <= 0) return 0;
  const double w0 = 2 * after + before, w1 = after + 2 * before;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

/// At an end: the parabola through three rows, cut to what keeps its cubic monotone.
double EndSlope(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0) return 0;
  if (d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
  return slope;
}

std::vector<JointVelocity> MonotoneSlopes(const JointTrajectory& t) {
  const std::vector<JointVelocity> d = Chords(t);
  const std::size_t n = d.size();
  if (n == 1) return {d[0], d[0]};
  std::vector<JointVelocity> m(n + 1, JointVelocity::Zero(t.joints));
  const auto length = [&](std::size_t i) { return t.times[i + 1] - t.times[i]; };
  for (Eigen::Index j = 0; j < t.joints.size(); ++j) {
    for (std::size_t i = 1; i < n; ++i)
      m[i](j) = MonotoneSlope(length(i - 1), length(i), d[i - 1](j), d[i](j));
    m[0](j) = EndSlope(length(0), length(1), d[0](j), d[1](j));
    m[n](j) = EndSlope(length(n - 1), length(n - 2), d[n - 1](j), d[n - 2](j));
  }
  return m;
}

std::vector<JointVelocity> SlopesOf(const TrajectorySource::Options& o) {
  if (o.trajectory.times.size() < 2) return {};
  if (o.interpolation == Interpolation::Cubic) return NaturalSlopes(o.trajectory);
  if (o.interpolation == Interpolation::Monotone) return MonotoneSlopes(o.trajectory);
  return {};
}

}  // namespace

const std::vector<std::string>& Words(Interpolation) {
  static const std::vector<std::string> words{"hold", "linear", "cubic", "monotone"};
  return words;
}

const std::vector<std::string>& Words(TrajectoryEnd) {
  static const std::vector<std::string> words{"hold", "stop"};
  return words;
}

TrajectorySource::TrajectorySource(const Options& o)
    : position{this, "position", Checked(o.trajectory).joints, o.trajectory.positions.front()},
      velocity{this, "velocity", o.trajectory.joints},
      acceleration{this, "acceleration", o.trajectory.joints},
      left{this, "left"},
      times_{o.trajectory.times},
      positions_{o.trajectory.positions},
      slopes_{SlopesOf(o)},
      interpolation_{o.interpolation},
      start_{o.start_s},
      point_{this,
             "point",
             {},
             Point{o.trajectory.positions.front(), JointVelocity::Zero(o.trajectory.joints),
                   JointAcceleration::Zero(o.trajectory.joints)}} {
  Require(std::isfinite(o.start_s), "start_s must be finite", o.start_s);
  Compute(point_).From(clock).As(&TrajectorySource::At);
  Compute(position).From(point_).As([](const Point& p) { return p.position; });
  Compute(velocity).From(point_).As([](const Point& p) { return p.velocity; });
  Compute(acceleration).From(point_).As([](const Point& p) { return p.acceleration; });
  Compute(left).From(clock).As(&TrajectorySource::Left);
  if (o.end == TrajectoryEnd::Stop) {
    Require(o.start_s + times_.back() > 0,
            "a run cannot end before it begins: start_s and the "
            "last time of the trajectory must add up to more than 0",
            o.start_s + times_.back());
    When(left).Crosses(Direction::Falling).Stop("the trajectory is over");
  }
}

double TrajectorySource::Left(double t) const { return times_.back() - (t - start_); }

TrajectorySource::Point TrajectorySource::At(double t) const {
  const double time = t - start_;
  Point p{positions_.front(), JointVelocity(PerJoint::Zero(positions_.front().size())),
          JointAcceleration(PerJoint::Zero(positions_.front().size()))};
  if (time >= times_.back()) p.position = positions_.back();
  if (time < times_.front() || time >= times_.back()) return p;

  const auto i =
      static_cast<std::size_t>(std::ranges::upper_bound(times_, time) - times_.begin()) - 1;
  const double h = times_[i + 1] - times_[i], s = (time - times_[i]) / h;
  const JointPosition &q0 = positions_[i], &q1 = positions_[i + 1];
  switch (interpolation_) {
    case Interpolation::Hold:
      p.position = q0;
      break;
    case Interpolation::Linear:
      p.position = q0 + s * (q1 - q0);
      p.velocity = (q1 - q0) / h;
      break;
    case Interpolation::Cubic:
    case Interpolation::Monotone: {
      // Hermite's: q₀ + h s m₀ + s² (3 Δ − h (2 m₀ + m₁)) + s³ (h (m₀ + m₁) − 2 Δ).
      const PerJoint rise = q1 - q0, m0 = h * slopes_[i], m1 = h * slopes_[i + 1];
      const PerJoint c = 3 * rise - 2 * m0 - m1, e = m0 + m1 - 2 * rise;
      p.position = q0 + s * (m0 + s * (c + s * e));
      p.velocity = (m0 + s * (2 * c + 3 * s * e)) / h;
      p.acceleration = (2 * c + 6 * s * e) / (h * h);
      break;
    }
  }
  return p;
}

}  // namespace pliant
