#pragma once

#include <vector>

#include "pliant/plants/depth_image.h"
#include "pliant/plants/depth_noise.h"
#include "pliant/plants/obstacle.h"
#include "pliant/plants/pinhole.h"
#include "pliant/plants/robot_surface.h"

namespace pliant {

/// Takes the robot, and what is known to stand around it, out of a depth image: a reading z is
/// theirs where the line of sight is inside one of their bodies from near to far, and
///
///   near − ε ≤ z ≤ far + ε,   ε = 3 σ(z) + ½ s z²
///
/// The bodies are all grown by `margin`, for errors of the joint angles, of the shapes and of the
/// camera's pose. Of the noise one reading in 740 comes nearer than 3 σ; those are left, each by
/// itself. A reading that is no positive finite number is none. What is behind a body is not seen,
/// so nothing else is lost but what is within ε of it along the line of sight, and beside it within
/// the margin.
class SelfFilter {
 public:
  struct Options {
    RobotModel model;
    Pinhole view = {};
    DepthNoise noise = {};
    std::vector<Obstacle> obstacles = {};
    double margin = 0.005;  ///< [m], ≥ 0
  };

  /// A picture without the robot. Made once, then only written in place.
  struct View {
    std::vector<Solid> parts;  ///< of the robot, in the camera's frame
    std::vector<Solid> grown;  ///< parts and obstacles
    std::vector<float> depth;  ///< what is left [m], 0: nothing
  };

  explicit SelfFilter(const Options& o);

  View MakeView() const;
  /// `d` at the measured joint angles when the picture was taken. No heap.
  void Apply(const DepthImage& image, const RobotDynamics& d, View& view) const;

  /// Whether a point, in the camera's frame, is out of the picture or behind a body.
  bool Hides(const View& view, const Eigen::Vector3d& x) const;

  double tolerance(double z) const;  ///< ε [m]
  const RobotSurface& surface() const { return surface_; }

 private:
  void TakeOut(const Solid& body, View& view) const;

  const RobotSurface surface_;
  const Pinhole view_;
  const DepthNoise noise_;
  const double margin_;
  std::vector<Solid> obstacles_;  // grown, in the camera's frame
};

}  // namespace pliant
