#include "pliant/controllers/motion_generator.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace pliant {

using Eigen::Matrix3d;
using Eigen::Vector3d;

MotionGenerator::MotionGenerator() {
  Compute(path_error).From(position, nearest).As([](const Position& p, const Position& p_d) {
    return PathError(p - p_d);
  });
}

CircleGenerator::CircleGenerator(const Options& o) : o_{o} {
  RequireInRange("", o);
  Require(o.center.allFinite(), "center must be finite", o.center.transpose());
  Compute(desired).From(position, velocity).As(&CircleGenerator::Desire);
  Compute(nearest).From(position).As(&CircleGenerator::Nearest);
}

LinearVelocity CircleGenerator::Desire(const Position& p, const LinearVelocity& v) const {
  const double lambda = o_.radius / o_.template_radius;
  const double x = (p.x() - o_.center.x()) / lambda, y = (p.y() - o_.center.y()) / lambda;
  const double rho = std::hypot(x, y), delta = std::atan2(y, x);
  const double c = std::cos(delta), s = std::sin(delta);
  const double outward = o_.radial_gain * (o_.template_radius - rho);
  const double round = rho * o_.angular_velocity;
  return {lambda * (outward * c - round * s), lambda * (outward * s + round * c),
          o_.height_gain * (o_.center.z() - p.z()) - o_.height_damping * v.z()};
}

Position CircleGenerator::Nearest(const Position& p) const {
  const double delta = std::atan2(p.y() - o_.center.y(), p.x() - o_.center.x());
  return o_.center + o_.radius * Vector3d(std::cos(delta), std::sin(delta), 0);
}

LimitCycleGenerator::LimitCycleGenerator(const Options& o) : o_{o} {
  RequireInRange("", o);
  Require(o.center.allFinite(), "center must be finite", o.center.transpose());
  // A rotation that was written down with nine digits passes.
  Require((o.axes * o.axes.transpose()).isIdentity(1e-8) && o.axes.determinant() > 0,
          "axes must be a rotation: R Rᵀ = I, det R = 1, got\n" + Text(o.axes));
  Require(o.harmonics.size() <= kMaxHarmonics, "harmonics must be at most " + Text(kMaxHarmonics),
          o.harmonics.size());
  // Between two of n angles ρ_d falls by at most half their distance times Σ k ‖(c_k, s_k)‖.
  constexpr int n = 4096;
  double steepest = 0;
  for (std::size_t k = 0; k < o.harmonics.size(); ++k)
    steepest += static_cast<double>(k + 1) * std::hypot(o.harmonics[k].cosine, o.harmonics[k].sine);
  const double margin = steepest * std::numbers::pi / n;
  for (int i = 0; i < n; ++i) {
    const double delta = 2 * std::numbers::pi * i / n, rho = At(delta).rho;
    Require(rho > margin,
            "the radius must be > 0 all round, so that the curve goes round its center once; at " +
                Text(delta) + " rad it is " + Text(rho) + " m: make the harmonics smaller");
  }
  Compute(desired).From(position, velocity).As(&LimitCycleGenerator::Desire);
  Compute(nearest).From(position).As(&LimitCycleGenerator::Nearest);
}

LimitCycleGenerator::Radius LimitCycleGenerator::At(double delta) const {
  Radius now{o_.radius, 0};
  double k = 0;
  for (const Harmonic& of : o_.harmonics) {
    ++k;
    const double c = std::cos(k * delta), s = std::sin(k * delta);
    now.rho += of.cosine * c + of.sine * s;
    now.slope += k * (of.sine * c - of.cosine * s);
  }
  return now;
}

LinearVelocity LimitCycleGenerator::Desire(const Position& p, const LinearVelocity& v) const {
  const Vector3d in_plane = o_.axes.transpose() * (p - o_.center);
  const double rho = std::hypot(in_plane.x(), in_plane.y());
  const double delta = std::atan2(in_plane.y(), in_plane.x());
  const double c = std::cos(delta), s = std::sin(delta);
  const Radius wanted = At(delta);
  const double outward = o_.radial_gain * (wanted.rho - rho) + wanted.slope * o_.angular_velocity;
  const double round = rho * o_.angular_velocity;
  const Vector3d desired_in_plane(
      outward * c - round * s, outward * s + round * c,
      -o_.height_gain * in_plane.z() - o_.height_damping * o_.axes.col(2).dot(v));
  return o_.axes * desired_in_plane;
}

Position LimitCycleGenerator::Nearest(const Position& p) const {
  const Vector3d in_plane = o_.axes.transpose() * (p - o_.center);
  const double delta = std::atan2(in_plane.y(), in_plane.x());
  const Vector3d on_curve = At(delta).rho * Vector3d(std::cos(delta), std::sin(delta), 0);
  return o_.center + o_.axes * on_curve;
}

GoalGenerator::GoalGenerator(const Options& o) : o_{o} {
  RequireInRange("", o);
  Require(o.goal.allFinite(), "goal must be finite", o.goal.transpose());
  const Matrix3d twice = o.gain + o.gain.transpose();
  Require(o.gain.allFinite() && twice.llt().info() == Eigen::Success,
          "gain must make ‖p − goal‖ fall from everywhere: A + Aᵀ positive definite, got A =\n" +
              Text(o.gain));
  Compute(desired).From(position, velocity).As(&GoalGenerator::Desire);
  Compute(nearest).From(position).As(&GoalGenerator::Nearest);
}

LinearVelocity GoalGenerator::Desire(const Position& p, const LinearVelocity&) const {
  const Vector3d u = o_.gain * (o_.goal - p);
  return u / std::hypot(1.0, u.norm() / o_.speed);
}

Position GoalGenerator::Nearest(const Position&) const { return o_.goal; }

}  // namespace pliant
