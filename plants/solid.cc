#include "pliant/plants/solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Passage kAll{-kInfinity, kInfinity};

/// Any rotation whose third column is a.
Eigen::Matrix3d About(const Vector3d& a) {
  Eigen::Matrix3d R;
  R.col(2) = a;
  R.col(0) = a.cross(std::abs(a.x()) < 0.7 ? Vector3d::UnitX() : Vector3d::UnitY()).normalized();
  R.col(1) = a.cross(R.col(0));
  return R;
}

Passage Both(const Passage& a, const Passage& b) {
  return {std::max(a.near, b.near), std::min(a.far, b.far)};
}

/// −h ≤ x + t v ≤ h.
Passage Between(double x, double v, double h) {
  if (v == 0) return std::abs(x) <= h ? kAll : Passage();
  const double s = (-h - x) / v, t = (h - x) / v;
  return {std::min(s, t), std::max(s, t)};
}

/// ‖o + t d‖ ≤ r.
Passage InBall(const Vector3d& o, const Vector3d& d, double r) {
  const double A = d.squaredNorm(), B = o.dot(d), C = o.squaredNorm() - r * r;
  const double discriminant = B * B - A * C;
  if (discriminant < 0) return {};
  const double root = std::sqrt(discriminant);
  return {(-B - root) / A, (-B + root) / A};
}

/// A line about a segment: along it, and beside it.
struct Beside {
  Beside(const Solid& s, const Vector3d& o, const Vector3d& d)
      : from{o - s.center}, along{s.axis().dot(from)}, along_rate{s.axis().dot(d)} {
    const Vector3d o_beside = from - along * s.axis();
    const Vector3d d_beside = d - along_rate * s.axis();
    const double A = d_beside.squaredNorm(), B = o_beside.dot(d_beside);
    const double C = o_beside.squaredNorm() - s.radius * s.radius;
    if (A <= 1e-24 * d.squaredNorm()) {  // parallel
      if (C <= 0) in = kAll;
      return;
    }
    const double discriminant = B * B - A * C;
    if (discriminant < 0) return;
    const double root = std::sqrt(discriminant);
    in = {(-B - root) / A, (-B + root) / A};
  }

  Vector3d from;
  double along, along_rate;
  Passage in;  // through the endless cylinder
};

Passage ThroughRound(const Solid& s, const Vector3d& o, const Vector3d& d) {
  const double L = s.half.z();
  if (L == 0) return InBall(o - s.center, d, s.radius);
  const Beside line(s, o, d);
  if (line.in.empty()) return {};
  const auto along = [&](double t) { return line.along + t * line.along_rate; };
  const auto at_end = [&](double x) {
    return InBall(line.from - std::copysign(L, x) * s.axis(), d, s.radius);
  };
  // What enters the endless cylinder beyond an end has to pass the ball there.
  Passage in = line.in;
  const double enters = along(in.near), leaves = along(in.far);
  if (!(std::abs(enters) <= L)) in.near = at_end(enters).empty() ? kInfinity : at_end(enters).near;
  if (!(std::abs(leaves) <= L)) in.far = at_end(leaves).empty() ? -kInfinity : at_end(leaves).far;
  return in;
}

Passage ThroughBox(const Solid& s, const Vector3d& o, const Vector3d& d) {
  const Vector3d x = s.rotation.transpose() * (o - s.center), v = s.rotation.transpose() * d;
  Passage in = kAll;
  for (int i = 0; i < 3; ++i) in = Both(in, Between(x(i), v(i), s.half(i)));
  return in;
}

Passage ThroughHull(const Solid& s, const Vector3d& o, const Vector3d& d) {
  Passage in = kAll;
  for (const Solid::Slab& slab : s.slabs) {
    const double middle = 0.5 * (slab.low + slab.high);
    in = Both(
        in, Between(slab.normal.dot(o) - middle, slab.normal.dot(d), 0.5 * (slab.high - slab.low)));
  }
  return in;
}

SurfacePoint NearestOnBox(const Solid& s, const Vector3d& x) {
  const Vector3d local = s.rotation.transpose() * (x - s.center);
  const Vector3d inside = local.cwiseMax(-s.half).cwiseMin(s.half);
  const Vector3d out = local - inside;
  if (out.norm() > 0) {
    const Vector3d n = s.rotation * out.normalized();
    return {out.norm(), x - out.norm() * n, n};
  }
  int face = 0;
  const double depth = (local.cwiseAbs() - s.half).maxCoeff(&face);
  const Vector3d n = std::copysign(1.0, local(face)) * s.rotation.col(face);
  return {depth, x - depth * n, n};
}

SurfacePoint NearestOnCylinder(const Solid& s, const Vector3d& x) {
  const Vector3d from = x - s.center;
  const double along = s.axis().dot(from);
  const Vector3d beside = from - along * s.axis();
  const double rho = beside.norm();
  const Vector3d radial = rho > 0 ? Vector3d(beside / rho) : Vector3d(s.rotation.col(0));
  const Vector3d end = std::copysign(1.0, along) * s.axis();
  const double out_radial = rho - s.radius, out_end = std::abs(along) - s.half.z();
  if (out_radial > 0 && out_end > 0) {
    const double distance = std::hypot(out_radial, out_end);
    const Vector3d n = (out_radial * radial + out_end * end) / distance;
    return {distance, x - distance * n, n};
  }
  if (out_radial > out_end) return {out_radial, x - out_radial * radial, radial};
  return {out_end, x - out_end * end, end};
}

SurfacePoint NearestOnHull(const Solid& s, const Vector3d& x) {
  SurfacePoint nearest{-kInfinity, x, Vector3d::UnitZ()};
  const auto offer = [&](double distance, const Vector3d& n) {
    if (distance > nearest.distance) nearest = {distance, x - distance * n, n};
  };
  for (const Solid::Slab& slab : s.slabs) {
    const double height = slab.normal.dot(x);
    offer(height - slab.high, slab.normal);
    offer(slab.low - height, -slab.normal);
  }
  return nearest;
}

/// x/z of the tangents to a circle about (c, z): all of the picture if it reaches behind.
Passage Slopes(double c, double z, double r) {
  if (z <= r) return kAll;
  const double A = z * z - r * r, root = r * std::sqrt(c * c + A);
  return {(c * z - root) / A, (c * z + root) / A};
}

struct Window {
  Passage x{kInfinity, -kInfinity}, y{kInfinity, -kInfinity};  // in slopes
  bool behind = false;  // some of the body is behind the camera

  void Add(const Passage& in_x, const Passage& in_y) {
    x = {std::min(x.near, in_x.near), std::max(x.far, in_x.far)};
    y = {std::min(y.near, in_y.near), std::max(y.far, in_y.far)};
  }
  void AddBall(const Vector3d& c, double r) {
    if (c.z() <= -r) {
      behind = true;
      return;
    }
    Add(Slopes(c.x(), c.z(), r), Slopes(c.y(), c.z(), r));
  }
  void AddCorner(const Vector3d& c) {
    if (c.z() <= 1e-6)
      Add(kAll, kAll);
    else
      Add({c.x() / c.z(), c.x() / c.z()}, {c.y() / c.z(), c.y() / c.z()});
  }
};

}  // namespace

Solid Solid::Of(const Shape& shape) {
  Solid s;
  s.center = shape.pose.position;
  s.rotation = shape.pose.rotation;
  switch (shape.kind) {
    case Shape::Kind::Box:
      s.kind = Kind::Box;
      s.half = 0.5 * shape.size;
      return s;
    case Shape::Kind::Sphere:
      s.radius = shape.size.x();
      return s;
    case Shape::Kind::Cylinder:
      s.kind = Kind::Cylinder;
      break;
    case Shape::Kind::Capsule:
      break;
  }
  s.radius = shape.size.x();
  s.half.z() = 0.5 * shape.size.y();
  return s;
}

Solid Solid::Of(const CollisionShape& shape) {
  Solid s;
  s.center = shape.center;
  if (!shape.is_polytope()) {
    s.PlaceCapsule(shape.center - shape.half, shape.center + shape.half, shape.radius);
    return s;
  }
  Require(shape.radius == 0, "a depth camera sees hulls with sharp edges: their radius must be 0",
          shape.radius);
  s.kind = Kind::Hull;
  for (const Vector3d& point : shape.points) s.corners.push_back(shape.center + point);
  for (const Vector3d& normal : shape.faces) {
    Slab slab{normal, kInfinity, -kInfinity};
    for (const Vector3d& corner : s.corners) {
      slab.low = std::min(slab.low, normal.dot(corner));
      slab.high = std::max(slab.high, normal.dot(corner));
    }
    s.slabs.push_back(slab);
  }
  return s;
}

void Solid::Place(const Pose& X, double margin, Solid& placed) const {
  placed.kind = kind;
  placed.center = X.position + X.rotation * center;
  placed.rotation = X.rotation * rotation;
  placed.half = half;
  placed.radius = radius + margin;
  if (kind == Kind::Box) placed.half.array() += margin;
  if (kind == Kind::Cylinder) placed.half.z() += margin;
  for (std::size_t i = 0; i < slabs.size(); ++i) {
    const Vector3d normal = X.rotation * slabs[i].normal;
    const double shift = normal.dot(X.position);
    placed.slabs[i] = {normal, slabs[i].low + shift - margin, slabs[i].high + shift + margin};
  }
  for (std::size_t i = 0; i < corners.size(); ++i)
    placed.corners[i] = X.position + X.rotation * corners[i];
}

void Solid::PlaceBall(const Vector3d& at, double r) {
  kind = Kind::Round;
  center = at;
  half.setZero();
  radius = r;
}

void Solid::PlaceCapsule(const Vector3d& a, const Vector3d& b, double r) {
  PlaceBall(0.5 * (a + b), r);
  const double length = (b - a).norm();
  if (length == 0) return;
  rotation = About((b - a) / length);
  half.z() = 0.5 * length;
}

Passage Pierce(const Solid& s, const Vector3d& o, const Vector3d& d) {
  switch (s.kind) {
    case Solid::Kind::Round:
      return ThroughRound(s, o, d);
    case Solid::Kind::Cylinder: {
      const Beside line(s, o, d);
      if (line.in.empty()) return {};
      return Both(line.in, Between(line.along, line.along_rate, s.half.z()));
    }
    case Solid::Kind::Box:
      return ThroughBox(s, o, d);
    case Solid::Kind::Hull:
      break;
  }
  return ThroughHull(s, o, d);
}

SurfacePoint NearestOn(const Solid& s, const Vector3d& x) {
  switch (s.kind) {
    case Solid::Kind::Box:
      return NearestOnBox(s, x);
    case Solid::Kind::Cylinder:
      return NearestOnCylinder(s, x);
    case Solid::Kind::Hull:
      return NearestOnHull(s, x);
    case Solid::Kind::Round:
      break;
  }
  const double along = std::clamp(s.axis().dot(x - s.center), -s.half.z(), s.half.z());
  const Vector3d from = x - s.center - along * s.axis();
  const double length = from.norm();
  const Vector3d n = length > 0 ? Vector3d(from / length) : Vector3d(s.rotation.col(0));
  return {length - s.radius, x - (length - s.radius) * n, n};
}

PixelRange PixelsOf(const Solid& s, const Pinhole& view) {
  Window w;
  switch (s.kind) {
    case Solid::Kind::Round:
    case Solid::Kind::Cylinder:
      w.AddBall(s.center - s.half.z() * s.axis(), s.radius);
      w.AddBall(s.center + s.half.z() * s.axis(), s.radius);
      break;
    case Solid::Kind::Box:
      for (int i = 0; i < 8; ++i) {
        const Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
        w.AddCorner(s.center + s.rotation * sign.cwiseProduct(s.half));
      }
      break;
    case Solid::Kind::Hull:
      // A margin has moved the faces out; of the corners that makes, what is within the margin of
      // the old ones is looked at.
      for (const Vector3d& corner : s.corners) w.AddBall(corner, s.radius);
      break;
  }
  const auto pixel = [&](double slope, int size) {
    return std::clamp(view.focal * slope + 0.5 * (size - 1), -1.0, size + 1.0);
  };
  const auto first = [&](double slope, int size) {
    return std::clamp(static_cast<int>(std::floor(pixel(slope, size))), 0, size);
  };
  const auto past = [&](double slope, int size) {
    return std::clamp(static_cast<int>(std::ceil(pixel(slope, size))) + 1, 0, size);
  };
  if (w.x.empty() || w.y.empty()) return {};
  if (w.behind) w.Add(kAll, kAll);
  return {first(w.x.near, view.width), first(w.y.near, view.height), past(w.x.far, view.width),
          past(w.y.far, view.height)};
}

}  // namespace pliant
