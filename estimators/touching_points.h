#pragma once

#include <array>
#include <vector>

#include "pliant/estimators/self_filter.h"

namespace pliant {

/// Where something that is not the robot touches it, as far as a depth image tells.
///
/// Points of the image within `reach` of the surface of a link that moves are joined to those up to
/// two pixels away whose depth differs by less than 3 √2 σ + s z² (or 5 mm); what hangs
/// together is one body. Of each body with at least `least_points` of them:
///
///   d₀ = the distance that a twentieth of its points are nearer than
///   x̄ = mean of its points nearer than d₀ + band
///
/// The link is the one most of these are nearest to, and the place is the point of its surface
/// nearest to x̄. The mean of many, not the single nearest point: that one is the one with the
/// largest noise, and of a hand seen from behind it is anywhere on a ring around the contact.
///
/// Bias: a camera sees one side of a body, and the self-filter takes off what is within some
/// h = ε + margin of the surface along the line of sight. Of a ball of radius r that touches at the
/// side, what is left nearest is half a ring of radius √(2 r h − h²), whose mean is 2/π of that off
/// towards the camera: 22 mm for 4 cm and h = 20 mm. `band` hardly changes it.
class TouchingPoints {
 public:
  struct Options {
    double reach = 0.06;  ///< [m]
    double band = 0.01;   ///< [m]
    int least_points = 15;
  };
  struct Place {
    int link = -1;
    Eigen::Vector3d point;   ///< on the link, in the camera's frame [m]
    Eigen::Vector3d normal;  ///< of its surface there
    double distance = 0;     ///< d₀ [m]
  };
  /// Bodies in one picture; the largest are kept.
  static constexpr int kMaxPlaces = 8;
  struct Places {
    int size = 0;
    std::array<Place, kMaxPlaces> at;
    int points = 0;  ///< within reach, of all bodies
  };
  /// Made once, then only written in place.
  struct Workspace {
    std::vector<float> distance;      // to the surface, of each pixel
    std::vector<unsigned char> part;  // nearest to it
    std::vector<int> queue;           // pixels of bodies, one body after the other
    std::vector<float> sorted;
    std::vector<int> votes;     // of parts
    std::vector<Solid> around;  // parts and what is within reach of them
  };

  TouchingPoints(const SelfFilter& filter, const Pinhole& view, const DepthNoise& noise,
                 const Options& o);

  Workspace MakeWorkspace() const;
  /// No heap; at most one look at each pixel for each part of the robot.
  Places Find(const SelfFilter::View& view, Workspace& w) const;

 private:
  void Measure(const SelfFilter::View& view, Workspace& w) const;
  int Join(const SelfFilter::View& view, Workspace& w, int begin) const;
  Place Touch(const SelfFilter::View& view, Workspace& w, int begin, int end) const;
  Eigen::Vector3d PointOf(const SelfFilter::View& view, int pixel) const;

  const RobotSurface surface_;
  const Pinhole view_;
  const DepthNoise noise_;
  const Options o_;
};

}  // namespace pliant
