#include "pliant/estimators/self_filter.h"

#include <algorithm>
#include <cmath>

namespace pliant {

using Eigen::Vector3d;

SelfFilter::SelfFilter(const Options& o)
    : surface_{o.model}, view_{o.view}, noise_{o.noise}, margin_{o.margin} {
  for (const Obstacle& obstacle : o.obstacles) {
    try {
      const Solid in_world = Solid::Of(ShapeOf(obstacle));
      obstacles_.push_back(in_world);
      in_world.Place(o.view.pose.inverse(), margin_, obstacles_.back());
    } catch (const Error& error) {
      throw Error(NameOf(obstacle) + ": " + error.what());
    }
  }
}

SelfFilter::View SelfFilter::MakeView() const {
  View view{surface_.Solids(), surface_.Solids(), {}};
  view.grown.insert(view.grown.end(), obstacles_.begin(), obstacles_.end());
  view.depth.resize(static_cast<std::size_t>(view_.pixels()));
  return view;
}

double SelfFilter::tolerance(double z) const {
  return 3 * noise_.Deviation(z) + 0.5 * noise_.Spacing(z);
}

void SelfFilter::Apply(const DepthImage& image, const RobotDynamics& d, View& view) const {
  surface_.Place(d, view_.pose, 0, view.parts);
  surface_.Place(d, view_.pose, margin_, view.grown);
  std::ranges::transform(image.depth, view.depth.begin(),
                         [](float z) { return std::isfinite(z) && z > 0 ? z : 0.0f; });
  for (const Solid& body : view.grown) TakeOut(body, view);
}

void SelfFilter::TakeOut(const Solid& body, View& view) const {
  const PixelRange range = PixelsOf(body, view_);
  for (int row = range.top; row < range.bottom; ++row)
    for (int column = range.left; column < range.right; ++column) {
      float& z = view.depth[static_cast<std::size_t>(row * view_.width + column)];
      if (z == 0) continue;
      const Passage in = Pierce(body, Vector3d::Zero(), view_.Ray(column, row));
      if (in.empty()) continue;
      const double e = tolerance(z);
      if (z >= in.near - e && z <= in.far + e) z = 0;
    }
}

bool SelfFilter::Hides(const View& view, const Vector3d& x) const {
  if (x.z() <= 0) return true;
  const Eigen::Vector2d pixel = view_.Project(x);
  if (!(pixel.x() >= -0.5 && pixel.x() < view_.width - 0.5 && pixel.y() >= -0.5 &&
        pixel.y() < view_.height - 0.5))
    return true;
  return std::ranges::any_of(view.grown, [&](const Solid& body) {
    const Passage in = Pierce(body, Vector3d::Zero(), x / x.z());
    return !in.empty() && in.near > 0 && in.near < x.z();
  });
}

}  // namespace pliant
