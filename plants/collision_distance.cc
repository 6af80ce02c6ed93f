#include "pliant/plants/collision_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

using Eigen::Vector3d;

std::size_t At(int i) { return static_cast<std::size_t>(i); }

/// Cores closer than this are taken to touch [m].
constexpr double kTouching = 1e-7;
/// Rounds of d = ‖z‖, where the softening of squares by δ d is that of distances by δ.
constexpr int kRounds = 12;
/// Relative change of d at which they end. Of a change, about δ/d is left in the next round, and e
/// is stationary in what is left.
constexpr double kSettled = 1e-6;

double Square(double x) { return x * x; }

/// A direction normal to u, and to v unless they are parallel.
Vector3d NormalTo(const Vector3d& u, const Vector3d& v) {
  const Vector3d both = u.cross(v);
  if (both.norm() > 1e-9 * u.norm() * v.norm()) return both.normalized();
  const Vector3d longer = u.norm() > v.norm() ? u : v;
  return longer.norm() > 0 ? longer.unitOrthogonal() : Vector3d::UnitZ();
}

/// Points and segments: x_a = c_a + s u, x_b = c_b + t v with s and t in [−1, 1].
Proximity ClosestOfSegments(const PlacedShape& A, const PlacedShape& B, double softening) {
  const Vector3d& u = A.half;
  const Vector3d& v = B.half;
  const Vector3d r = A.center - B.center;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double ru = r.dot(u), rv = r.dot(v);
  const double delta = A.shape->extent > 0 && B.shape->extent > 0 ? softening : 0;

  const double rr = r.squaredNorm();
  double d = std::sqrt(rr), s = 0, t = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double a = uu + delta * d, b = vv + delta * d;
    const double det = a * b - uv * uv;
    s = det > 1e-14 * a * b ? std::clamp((uv * rv - ru * b) / det, -1.0, 1.0) : 0;
    t = b > 0 ? (uv * s + rv) / b : 0;
    if (t < -1 || t > 1) {
      t = std::clamp(t, -1.0, 1.0);
      s = a > 0 ? std::clamp((uv * t - ru) / a, -1.0, 1.0) : 0;
    } else if (det <= 1e-14 * a * b && a > 0) {
      s = std::clamp((uv * t - ru) / a, -1.0, 1.0);
    }
    if (delta == 0) break;
    const double before = d;
    d = std::sqrt(std::max(0.0, rr + 2 * (s * ru - t * rv - s * t * uv) + s * s * uu + t * t * vv));
    if (std::abs(d - before) <= kSettled * d) break;
  }
  const Vector3d z = r + s * u - t * v;
  d = z.norm();

  Proximity p;
  p.a = A.center + s * u;
  p.b = B.center + t * v;
  if (d > 1e-9) {
    p.normal = z / d;
  } else {
    p.normal = NormalTo(u, v);
    if (p.normal.dot(r) < 0) p.normal = -p.normal;
  }
  const double soft = delta > 0 ? delta * (0.5 * (s * s + t * t) - 1) : 0;
  p.distance = d + soft - A.shape->radius - B.shape->radius;
  return p;
}

/// The points of a core about its centre, world axes.
struct Points {
  explicit Points(const PlacedShape& placed) {
    if (!placed.shape->is_polytope()) {
      at[0] = placed.half;
      at[1] = -placed.half;
      count = placed.shape->extent > 0 ? 2 : 1;
      return;
    }
    for (const Vector3d& point : placed.shape->points)
      at[At(count++)].noalias() = *placed.rotation * point;
  }

  int Furthest(const Vector3d& direction) const {
    int best = 0;
    double most = direction.dot(at[0]);
    for (int i = 1; i < count; ++i)
      if (const double reach = direction.dot(at[At(i)]); reach > most) {
        most = reach;
        best = i;
      }
    return best;
  }

  std::array<Vector3d, CollisionShape::kMaxPoints> at;
  int count = 0;
};

/// The point of least norm of a polytope, by Wolfe's method: that of
///
///   (z, √ε_a y_a, √ε_b y_b),   z = r + y_a − y_b,   r = c_a − c_b
///
/// over the points y of the cores about their centres. The scalar products of such vectors are all
/// it takes. `corners` are pairs of points that span a simplex with the least one inside of it;
/// their weights add up to one.
class LeastNorm {
 public:
  LeastNorm(const Points& a, const Points& b, const Vector3d& r) : a_{a}, b_{b}, r_{r} {
    Add(a.Furthest(-r), b.Furthest(r), 1);
    Sum();
  }

  void Solve(double eps_a, double eps_b) {
    eps_a_ = eps_a;
    eps_b_ = eps_b;
    std::array<Corner, kMaxCorners> before = corner_;
    int count = count_;
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!Descend()) {  // the new corner is in the plane of the others, but for round-off
        corner_ = before;
        count_ = count;
        return;
      }
      Sum();
      const Vector3d pull_a = z + eps_a_ * y_a, pull_b = z - eps_b_ * y_b;
      const int i = a_.Furthest(-pull_a), k = b_.Furthest(pull_b);
      const double norm = z.squaredNorm() + eps_a_ * y_a.squaredNorm() + eps_b_ * y_b.squaredNorm();
      const double least = pull_a.dot(a_.at[At(i)]) - pull_b.dot(b_.at[At(k)]) + z.dot(r_);
      const double size =
          r_.squaredNorm() + a_.at[At(i)].squaredNorm() + b_.at[At(k)].squaredNorm();
      if (norm - least <= 5e-15 * size || count_ == kMaxCorners || Has(i, k)) return;
      before = corner_;
      count = count_;
      Add(i, k, 0);
    }
  }

  Vector3d z, y_a, y_b;

 private:
  static constexpr int kMaxCorners = 7;  // of a simplex in six dimensions
  static constexpr int kMaxRounds = 100;
  using Column = std::array<double, kMaxCorners>;
  using Square = std::array<Column, kMaxCorners>;

  /// Scalar products of two corners' parts.
  struct Products {
    double z, a, b;
  };
  struct Corner {
    int a, b;
    Vector3d z;
    double weight;
    std::array<Products, kMaxCorners> with;  // the corners before it, and itself
  };

  void Add(int i, int k, double weight) {
    const Vector3d &a = a_.at[At(i)], &b = b_.at[At(k)];
    Corner& added = corner_[At(count_++)];
    added.a = i;
    added.b = k;
    added.z = r_ + a - b;
    added.weight = weight;
    for (int j = 0; j < count_; ++j) {
      const Corner& c = corner_[At(j)];
      added.with[At(j)] = {added.z.dot(c.z), a.dot(a_.at[At(c.a)]), b.dot(b_.at[At(c.b)])};
    }
  }
  bool Has(int i, int k) const {
    return std::any_of(corner_.begin(), corner_.begin() + count_,
                       [&](const Corner& c) { return c.a == i && c.b == k; });
  }
  void Sum() {
    y_a.setZero();
    y_b.setZero();
    for (int i = 0; i < count_; ++i) {
      y_a += corner_[At(i)].weight * a_.at[At(corner_[At(i)].a)];
      y_b += corner_[At(i)].weight * b_.at[At(corner_[At(i)].b)];
    }
    z = r_ + y_a - y_b;
  }

  /// y with G y = 1, and L with G = L Lᵀ in the place of G. False if G is not positive definite. By
  /// hand: for matrices of this size Eigen's factorization takes twice as long.
  static bool SolveOnes(Square& G, int n, Column& y) {
    Column inverse;  // of the diagonal of L
    for (std::size_t i = 0; i < At(n); ++i) {
      double x = 1;
      for (std::size_t k = 0; k <= i; ++k) {
        double sum = G[i][k];
        for (std::size_t j = 0; j < k; ++j) sum -= G[i][j] * G[k][j];
        if (k < i) {
          G[i][k] = sum * inverse[k];
          x -= G[i][k] * y[k];
        } else {
          if (!(sum > 0)) return false;
          inverse[i] = 1 / std::sqrt(sum);
          y[i] = x * inverse[i];
        }
      }
    }
    for (std::size_t i = At(n); i-- > 0;) {
      for (std::size_t k = i + 1; k < At(n); ++k) y[i] -= G[k][i] * y[k];
      y[i] *= inverse[i];
    }
    return true;
  }

  /// To the least point of the plane through the corners, without the corners that are left on the
  /// way. False if they are so flat that no better point is to be had.
  bool Descend() {
    while (true) {
      Square G;
      Column y;
      double scale = 0;
      for (std::size_t i = 0; i < At(count_); ++i) {
        for (std::size_t k = 0; k <= i; ++k) {
          const Products& of = corner_[i].with[k];
          G[i][k] = of.z + eps_a_ * of.a + eps_b_ * of.b;
        }
        scale = std::max(scale, G[i][i]);
      }
      // With 1 1ᵀ added, scaled, it has full rank also where the plane goes through the origin.
      if (!(scale > 0)) return false;
      if (count_ == 1) return true;
      for (std::size_t i = 0; i < At(count_); ++i)
        for (std::size_t k = 0; k <= i; ++k) G[i][k] += scale;
      if (!SolveOnes(G, count_, y)) return false;
      double sum = 0;
      for (int i = 0; i < count_; ++i) sum += y[At(i)];
      for (int i = 0; i < count_; ++i) {
        y[At(i)] /= sum;
        if (!std::isfinite(y[At(i)])) return false;
      }
      double step = 1;
      int out = -1;
      for (int i = 0; i < count_; ++i)
        if (const double w = corner_[At(i)].weight; y[At(i)] <= 0 && w / (w - y[At(i)]) < step) {
          step = w / (w - y[At(i)]);
          out = i;
        }
      for (int i = 0; i < count_; ++i) {
        double& w = corner_[At(i)].weight;
        w = std::max(0.0, w + step * (y[At(i)] - w));
      }
      if (out < 0) return true;
      Drop(out);
    }
  }
  void Drop(int out) {
    std::copy(corner_.begin() + out + 1, corner_.begin() + count_, corner_.begin() + out);
    --count_;
    for (int i = out; i < count_; ++i) {
      std::array<Products, kMaxCorners>& with = corner_[At(i)].with;
      std::copy(with.begin() + out + 1, with.begin() + i + 2, with.begin() + out);
    }
    double sum = 0;
    for (int i = 0; i < count_; ++i) sum += corner_[At(i)].weight;
    for (int i = 0; i < count_; ++i)
      corner_[At(i)].weight = sum > 0 ? corner_[At(i)].weight / sum : 1.0 / count_;
  }

  const Points& a_;
  const Points& b_;
  const Vector3d r_;
  double eps_a_ = 0, eps_b_ = 0;
  std::array<Corner, kMaxCorners> corner_;
  int count_ = 0;
};

/// The least translation of a that parts two overlapping cores.
class Parting {
 public:
  Parting(const PlacedShape& A, const PlacedShape& B, const Points& a, const Points& b)
      : a_{a}, b_{b}, r_{A.center - B.center} {
    for (const Vector3d& face : A.shape->faces)
      if (const Vector3d n = *A.rotation * face; Try(n)) {
        x_b = b_.at[At(b_.Furthest(normal))];
        x_a = x_b - r_ - depth * normal;
      }
    for (const Vector3d& face : B.shape->faces)
      if (const Vector3d n = *B.rotation * face; Try(n)) {
        x_a = a_.at[At(a_.Furthest(-normal))];
        x_b = x_a + r_ + depth * normal;
      }
    ForEdges(A, [&](const Vector3d& of_a) {
      ForEdges(B, [&](const Vector3d& of_b) {
        const Vector3d across = of_a.cross(of_b);
        const double sine = across.norm();
        if (sine < 1e-9 || !Try(across / sine)) return;
        // Where the lines of the two edges are closest.
        x_a = a_.at[At(a_.Furthest(-normal))];
        x_b = b_.at[At(b_.Furthest(normal))];
        const Vector3d z = r_ + x_a - x_b;
        x_a -= z.cross(of_b).dot(across) / (sine * sine) * of_a;
        x_b = x_a + r_ + depth * normal;
      });
    });
  }

  Vector3d x_a = Vector3d::Zero(), x_b = Vector3d::Zero();  // about the centres
  double depth = std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::UnitZ();

 private:
  template <class F>
  static void ForEdges(const PlacedShape& placed, const F& f) {
    if (placed.shape->is_polytope())
      for (const Vector3d& edge : placed.shape->edges) f(*placed.rotation * edge);
    else if (placed.shape->extent > 0)
      f(placed.half / placed.shape->extent);
  }
  /// Whether it is shorter along n, or against it, than all before.
  bool Try(const Vector3d& n) {
    const double r = r_.dot(n);
    const double above = b_.at[At(b_.Furthest(n))].dot(n) - a_.at[At(a_.Furthest(-n))].dot(n) - r;
    const double below = a_.at[At(a_.Furthest(n))].dot(n) - b_.at[At(b_.Furthest(-n))].dot(n) + r;
    if (std::min(above, below) >= depth) return false;
    depth = std::min(above, below);
    normal = above <= below ? n : Vector3d(-n);
    return true;
  }

  const Points& a_;
  const Points& b_;
  const Vector3d r_;
};

Proximity ClosestOfPolytopes(const PlacedShape& A, const PlacedShape& B, double softening) {
  const Points a(A), b(B);
  const double R_a = A.shape->extent, R_b = B.shape->extent;
  const double delta = R_a > 0 && R_b > 0 ? softening : 0;
  const double radii = A.shape->radius + B.shape->radius;

  LeastNorm least(a, b, A.center - B.center);
  least.Solve(0, 0);
  double d = least.z.norm();
  Proximity p;
  if (!(d > kTouching)) {
    const Parting parting(A, B, a, b);
    p.normal = parting.normal;
    p.a = A.center + parting.x_a;
    p.b = B.center + parting.x_b;
    p.distance = -parting.depth - delta - radii;
    return p;
  }
  double soft = 0;
  if (delta > 0) {
    for (int round = 0; round < kRounds; ++round) {
      least.Solve(delta * d / Square(R_a), delta * d / Square(R_b));
      const double before = d;
      d = least.z.norm();
      if (std::abs(d - before) <= kSettled * d) break;
    }
    soft =
        delta *
        (0.5 * (least.y_a.squaredNorm() / Square(R_a) + least.y_b.squaredNorm() / Square(R_b)) - 1);
  }
  p.normal = least.z / d;
  p.a = A.center + least.y_a;
  p.b = B.center + least.y_b;
  p.distance = d + soft - radii;
  return p;
}

}  // namespace

Proximity Closest(const PlacedShape& a, const PlacedShape& b, double softening) {
  if (a.shape->is_polytope() || b.shape->is_polytope()) return ClosestOfPolytopes(a, b, softening);
  return ClosestOfSegments(a, b, softening);
}

}  // namespace pliant
