// Distances of polytopes by CGAL, in exact arithmetic, against ours.

#include <CGAL/Cartesian.h>
#include <CGAL/Gmpzf.h>
#include <CGAL/Polytope_distance_d.h>
#include <CGAL/Polytope_distance_d_traits_3.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/tests/plants/collision_scene.h"

namespace pliant {
namespace {

using Kernel = CGAL::Cartesian<double>;
using Traits = CGAL::Polytope_distance_d_traits_3<Kernel, CGAL::Gmpzf, double>;

double ExactDistance(const PosedShape& a, const PosedShape& b) {
  const auto exact = [](const PosedShape& body) {
    std::vector<Kernel::Point_3> all;
    for (const Eigen::Vector3d& p : CorePoints(body)) all.emplace_back(p.x(), p.y(), p.z());
    return all;
  };
  const std::vector<Kernel::Point_3> p = exact(a), q = exact(b);
  const CGAL::Polytope_distance_d<Traits> distance(p.begin(), p.end(), q.begin(), q.end());
  return std::sqrt(CGAL::to_double(distance.squared_distance_numerator()) /
                   CGAL::to_double(distance.squared_distance_denominator()));
}

TEST(CollisionDistance, IsThatOfCgalInExactArithmeticForAnyTwoShapes) {
  RandomBodies draw(3);
  int apart = 0;
  for (int k = 0; k < 4000; ++k) {
    const PosedShape a{draw.Shape(k), draw.Pose(0.2)};
    const PosedShape b{draw.Shape(k / RandomBodies::kKinds), draw.Pose(0.2)};
    const double cores = ExactDistance(a, b);
    const Proximity p = Between(a, b);
    if (cores < 1e-6) {
      EXPECT_LT(p.distance + a.shape.radius + b.shape.radius, 1e-9) << "overlapping, " << k;
      continue;
    }
    ++apart;
    // Points are rounded to 1e-17 m; what is left of the gap that ends the search is 1e-15 m² in
    // the square, less than 1e-15/(2 · 1e-3) m in what is mostly more than a millimetre.
    EXPECT_NEAR(p.distance, cores - a.shape.radius - b.shape.radius, 1e-12 + 1e-15 / cores) << k;
    EXPECT_LT((p.a - p.b - cores * p.normal).norm(), 1e-7) << k;
  }
  EXPECT_GT(apart, 2000);
}

}  // namespace
}  // namespace pliant
