#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pliant/plants/depth_image.h"
#include "pliant/plants/depth_noise.h"
#include "pliant/plants/obstacle.h"
#include "pliant/plants/pinhole.h"
#include "pliant/plants/robot_surface.h"
#include "pliant/systems/block.h"
#include "pliant/systems/random.h"

namespace pliant {

/// A depth camera that looks at a robot, at what stands around it, and at the hands that push it.
///
/// Every h it takes a picture: each pixel sees the nearest body that its line of sight meets, in
/// closed form, with the noise and the steps of DepthNoise; a reading out of range, or at too flat
/// an angle, is missing. Bodies are the collision shapes of the links, the obstacles, and for each
/// contact with a force a PushingHand; nothing else is there, and what has no reading is not seen.
///
/// `exposure` is all that the picture depends on, so the picture is made when somebody looks at it
/// and needs no place in a snapshot. The noise is a function of (seed, picture, pixel).
///
/// Assumes: no motion blur, no delay, no errors of the pose or the lens; pixels do not mix what is
/// in front with what is behind. A hand is there as long as its force is.
class DepthCamera final : public Block {
 public:
  /// Hands that a picture shows; further ones are not drawn.
  static constexpr int kMaxHands = 8;

  struct Options {
    RobotModel model;
    Pinhole view = {};
    Duration period = Hertz(30);
    double nearest = 0.5;   ///< reading [m]
    double farthest = 4.5;  ///< reading [m]
    DepthNoise noise = {};
    double hand_radius = 0.04;     ///< [m]
    double forearm_radius = 0.03;  ///< [m], at most the hand's, so that it stays off the link
    double forearm_length = 0.3;   ///< [m]
    std::vector<Obstacle> obstacles = {};
    std::uint64_t seed = 1;

    template <class F>
    void Parameters(F&& f) {
      f("view", view);
      f("period", period);
      f("nearest", nearest, "m", kPositive);
      f("farthest", farthest, "m", kPositive);
      f("noise", noise);
      f("hand_radius", hand_radius, "m", kPositive);
      f("forearm_radius", forearm_radius, "m", kPositive);
      f("forearm_length", forearm_length, "m", kPositive);
    }
  };

  /// What there was to see when picture `number` was taken, −1: none yet.
  struct Exposure {
    double number = -1;
    double time = -1;  ///< [s]
    JointPosition q;   ///< of the robot
    double hands = 0;  ///< how many there are
    std::array<ContactForce, kMaxHands> hand;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("number", number, "");
      f("time", time, "s");
      f("q", q, "rad");
      f("hands", hands, "");
      f("hand", hand, "");
    }
  };

  explicit DepthCamera(const Options& o);

  Input<JointPosition> position;     ///< of the plant
  InputList<ContactForce> contacts;  ///< only to be seen
  Output<Exposure> exposure;
  Output<DepthImage> image;

 private:
  struct Workspace {
    RobotDynamics dynamics;
    std::vector<Solid> solids;        // parts, hands, obstacles, in the camera's frame
    std::vector<unsigned char> seen;  // which of them a pixel sees
  };

  Workspace MakeWorkspace(const Options& o) const;
  Exposure Expose(double t, const JointPosition& q, const Joined<ContactForce>& contacts) const;
  void Render(DepthImage& image, Workspace& w, const Exposure& e) const;
  int PlaceAll(Workspace& w, const Exposure& e) const;
  PixelRange Cast(DepthImage& image, Workspace& w, std::size_t solid) const;
  void Disturb(DepthImage& image, const Workspace& w, const PixelRange& range,
               std::uint64_t number) const;

  const RobotModel model_;
  const RobotSurface surface_;
  const Pinhole view_;
  const DepthNoise noise_;
  const double h_, nearest_, farthest_, hand_, forearm_, forearm_length_;
  const RandomStream random_;
  const int obstacles_;
  Scratch<Workspace> workspace_;
};

}  // namespace pliant
