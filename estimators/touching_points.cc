#include "pliant/estimators/touching_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/systems/error.h"

namespace pliant {

using Eigen::Vector3d;

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr int kMaxParts = 255;       // that a byte tells apart
constexpr int kWindow = 2;           // [px] between points of a body
constexpr double kLeastGap = 0.005;  // [m] in depth, for what is seen without noise

std::size_t At(int i) { return static_cast<std::size_t>(i); }

}  // namespace

TouchingPoints::TouchingPoints(const SelfFilter& filter, const Pinhole& view,
                               const DepthNoise& noise, const Options& o)
    : surface_{filter.surface()}, view_{view}, noise_{noise}, o_{o} {
  Require(surface_.size() <= kMaxParts,
          "contacts are looked for on at most " + Text(kMaxParts) + " shapes of links",
          surface_.size());
}

TouchingPoints::Workspace TouchingPoints::MakeWorkspace() const {
  const std::size_t pixels = At(view_.pixels());
  return {
      std::vector<float>(pixels), std::vector<unsigned char>(pixels),    std::vector<int>(pixels),
      std::vector<float>(pixels), std::vector<int>(At(surface_.size())), surface_.Solids()};
}

Vector3d TouchingPoints::PointOf(const SelfFilter::View& view, int pixel) const {
  return view.depth[At(pixel)] * view_.Ray(pixel % view_.width, pixel / view_.width);
}

/// The distance of each point to the surface, as far as it is within reach.
void TouchingPoints::Measure(const SelfFilter::View& view, Workspace& w) const {
  std::ranges::fill(w.distance, kFar);
  for (int i = 0; i < surface_.size(); ++i) {
    if (surface_.part(i).body < 0) continue;
    view.parts[At(i)].Place(Pose(), o_.reach, w.around[At(i)]);
    const PixelRange range = PixelsOf(w.around[At(i)], view_);
    for (int row = range.top; row < range.bottom; ++row)
      for (int column = range.left; column < range.right; ++column) {
        const std::size_t pixel = At(row * view_.width + column);
        const float z = view.depth[pixel];
        if (z == 0) continue;
        const float distance =
            static_cast<float>(NearestOn(view.parts[At(i)], z * view_.Ray(column, row)).distance);
        if (distance > o_.reach || distance >= w.distance[pixel]) continue;
        w.distance[pixel] = distance;
        w.part[pixel] = static_cast<unsigned char>(i);
      }
  }
}

/// Adds all that hangs together with the first pixel of a body; returns where it ends.
int TouchingPoints::Join(const SelfFilter::View& view, Workspace& w, int begin) const {
  int end = begin + 1;
  for (int i = begin; i < end; ++i) {
    const int pixel = w.queue[At(i)];
    const int column = pixel % view_.width, row = pixel / view_.width;
    const double z = view.depth[At(pixel)];
    const double gap =
        std::max(3 * std::numbers::sqrt2 * noise_.Deviation(z) + noise_.Spacing(z), kLeastGap);
    for (int r = std::max(row - kWindow, 0); r <= std::min(row + kWindow, view_.height - 1); ++r)
      for (int c = std::max(column - kWindow, 0); c <= std::min(column + kWindow, view_.width - 1);
           ++c) {
        const int other = r * view_.width + c;
        if (w.distance[At(other)] == kFar || std::abs(view.depth[At(other)] - z) > gap) continue;
        w.sorted[At(end)] = w.distance[At(other)];
        w.queue[At(end++)] = other;
        w.distance[At(other)] = kFar;  // taken
      }
  }
  return end;
}

TouchingPoints::Place TouchingPoints::Touch(const SelfFilter::View& view, Workspace& w, int begin,
                                            int end) const {
  const auto first = w.sorted.begin() + begin, last = w.sorted.begin() + end;
  const auto twentieth = first + (end - begin) / 20;
  std::nth_element(first, twentieth, last);
  const double d0 = *twentieth;

  Vector3d mean = Vector3d::Zero();
  int near = 0;
  std::ranges::fill(w.votes, 0);
  for (int i = begin; i < end; ++i) {
    const int pixel = w.queue[At(i)];
    const int part = w.part[At(pixel)];
    const Vector3d x = PointOf(view, pixel);
    if (NearestOn(view.parts[At(part)], x).distance > d0 + o_.band) continue;
    mean += x;
    ++near;
    ++w.votes[At(part)];
  }
  mean /= std::max(near, 1);
  const int part = static_cast<int>(std::ranges::max_element(w.votes) - w.votes.begin());
  const int link = surface_.part(part).link;
  const SurfacePoint on = surface_.NearestOnLink(link, view.parts, mean);
  return {link, on.point, on.normal, d0};
}

TouchingPoints::Places TouchingPoints::Find(const SelfFilter::View& view, Workspace& w) const {
  Measure(view, w);
  struct Body {
    int begin, end;
    int size() const { return end - begin; }
  };
  std::array<Body, kMaxPlaces> bodies{};
  Places found;
  int used = 0;
  for (int pixel = 0; pixel < view_.pixels(); ++pixel) {
    if (w.distance[At(pixel)] == kFar) continue;
    w.queue[At(used)] = pixel;
    w.sorted[At(used)] = w.distance[At(pixel)];
    w.distance[At(pixel)] = kFar;
    const Body body{used, Join(view, w, used)};
    used = body.end;
    const auto smallest = std::ranges::min_element(bodies, {}, &Body::size);
    if (body.size() >= o_.least_points && body.size() > smallest->size()) *smallest = body;
  }
  found.points = used;
  for (const Body& body : bodies)
    if (body.size() > 0) found.at[At(found.size++)] = Touch(view, w, body.begin, body.end);
  return found;
}

}  // namespace pliant
