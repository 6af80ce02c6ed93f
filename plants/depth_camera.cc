#include "pliant/plants/depth_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/plants/contacts.h"
#include "pliant/plants/pushing_hand.h"
#include "pliant/systems/elements.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr double kLeastForce = 0.01;      // [N] below it a force has no direction to speak of
constexpr int kMaxSolids = 250;           // that a byte tells apart
constexpr std::uint64_t kPictures = 500;  // other numbers than of other uses of the seed

PixelRange Around(const PixelRange& a, const PixelRange& b) {
  if (a.left >= a.right || a.top >= a.bottom) return b;
  if (b.left >= b.right || b.top >= b.bottom) return a;
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

DepthImage Blank(const DepthCamera::Options& o) {
  RequireInRange("", o);
  return DepthImage(o.view.width, o.view.height);
}

}  // namespace

DepthCamera::DepthCamera(const Options& o)
    : position{this, "position", o.model.joints()},
      contacts{this, "contacts"},
      exposure{
          this, "exposure", {}, Exposure{.q = JointPosition::Zero(o.model.joints()), .hand = {}}},
      image{this, "image", {}, Blank(o)},
      model_{o.model},
      surface_{o.model},
      view_{o.view},
      noise_{o.noise},
      h_{seconds(o.period)},
      nearest_{o.nearest},
      farthest_{o.farthest},
      hand_{o.hand_radius},
      forearm_{o.forearm_radius},
      forearm_length_{o.forearm_length},
      random_{RandomStream(o.seed).Part(kPictures)},
      obstacles_{static_cast<int>(o.obstacles.size())},
      workspace_{this, "workspace", MakeWorkspace(o)} {
  Require(o.farthest > o.nearest, "farthest must be > nearest = " + Text(o.nearest) + " m",
          o.farthest);
  Require(o.forearm_radius <= o.hand_radius,
          "forearm_radius must be at most hand_radius = " + Text(o.hand_radius) +
              " m, or the forearm would reach into what the hand touches",
          o.forearm_radius);
  Every(o.period).Compute(exposure).From(clock, position, contacts).As(&DepthCamera::Expose);
  Compute(image).From(workspace_, exposure).As(&DepthCamera::Render);
}

DepthCamera::Workspace DepthCamera::MakeWorkspace(const Options& o) const {
  Workspace w{RobotDynamics(o.model), surface_.Solids(), {}};
  w.solids.resize(w.solids.size() + 2 * kMaxHands);
  for (const Obstacle& obstacle : o.obstacles) {
    try {
      w.solids.push_back(Solid::Of(ShapeOf(obstacle)));
    } catch (const Error& error) {
      throw Error(NameOf(obstacle) + ": " + error.what());
    }
    const Solid in_world = w.solids.back();
    in_world.Place(o.view.pose.inverse(), 0, w.solids.back());
  }
  Require(w.solids.size() <= kMaxSolids,
          "a camera sees at most " + Text(kMaxSolids) + " shapes, hands and obstacles",
          w.solids.size());
  w.seen.resize(static_cast<std::size_t>(o.view.pixels()));
  return w;
}

DepthCamera::Exposure DepthCamera::Expose(double t, const JointPosition& q,
                                          const Joined<ContactForce>& forces) const {
  Exposure e{static_cast<double>(TickAt(t, h_)), t, q, 0, {}};
  for (int i = 0; i < forces.size() && e.hands < kMaxHands; ++i) {
    const bool acts = forces[i].force.norm() > kLeastForce && forces[i].point.allFinite();
    if (!IsLink(model_, forces[i].link) || !acts) continue;
    e.hand[static_cast<std::size_t>(e.hands)] = forces[i];
    e.hands += 1;
  }
  return e;
}

/// Returns how many hands there are.
int DepthCamera::PlaceAll(Workspace& w, const Exposure& e) const {
  ComputeDynamics(model_, e.q, JointVelocity::Zero(model_.joints()), w.dynamics);
  const std::size_t parts = static_cast<std::size_t>(surface_.size());
  const std::span<Solid> placed(w.solids.data(), parts);
  surface_.Place(w.dynamics, view_.pose, 0, placed);
  const Pose X_CW = view_.pose.inverse();
  const int hands = static_cast<int>(e.hands);
  for (int i = 0; i < hands; ++i) {
    const ContactForce& force = e.hand[static_cast<std::size_t>(i)];
    const Pose X_CL = X_CW * LinkPose(model_, w.dynamics, force.link);
    const PushingHand hand =
        HandOf(surface_, placed, force.link, X_CL.position + X_CL.rotation * force.point,
               X_CW.rotation * force.force, hand_, forearm_length_);
    const std::size_t at = parts + 2 * static_cast<std::size_t>(i);
    w.solids[at].PlaceBall(hand.center, hand_);
    w.solids[at + 1].PlaceCapsule(hand.center, hand.elbow, forearm_);
  }
  return hands;
}

void DepthCamera::Render(DepthImage& out, Workspace& w, const Exposure& e) const {
  out.time = e.time;
  std::ranges::fill(out.depth, 0.0f);
  if (e.number < 0) return;
  const std::size_t parts = static_cast<std::size_t>(surface_.size());
  const std::size_t hands = static_cast<std::size_t>(PlaceAll(w, e));
  PixelRange touched;
  for (std::size_t i = 0; i < parts + 2 * hands; ++i) touched = Around(touched, Cast(out, w, i));
  for (std::size_t i = w.solids.size() - static_cast<std::size_t>(obstacles_); i < w.solids.size();
       ++i)
    touched = Around(touched, Cast(out, w, i));
  Disturb(out, w, touched, static_cast<std::uint64_t>(e.number));
}

/// Draws a body where it is the nearest so far; without noise, at any distance.
PixelRange DepthCamera::Cast(DepthImage& out, Workspace& w, std::size_t solid) const {
  const Solid& body = w.solids[solid];
  const PixelRange range = PixelsOf(body, view_);
  for (int row = range.top; row < range.bottom; ++row)
    for (int column = range.left; column < range.right; ++column) {
      const Passage in = Pierce(body, Vector3d::Zero(), view_.Ray(column, row));
      if (in.empty() || in.near <= 0) continue;
      const std::size_t pixel = static_cast<std::size_t>(row * view_.width + column);
      if (out.depth[pixel] > 0 && out.depth[pixel] <= in.near) continue;
      out.depth[pixel] = static_cast<float>(in.near);
      w.seen[pixel] = static_cast<unsigned char>(solid);
    }
  return range;
}

void DepthCamera::Disturb(DepthImage& out, const Workspace& w, const PixelRange& range,
                          std::uint64_t number) const {
  const RandomStream random = random_.Part(number);
  const double flattest = std::cos(noise_.widest_deg * std::numbers::pi / 180);
  for (int row = range.top; row < range.bottom; ++row)
    for (int column = range.left; column < range.right; ++column) {
      const std::size_t pixel = static_cast<std::size_t>(row * view_.width + column);
      const double exact = out.depth[pixel];
      if (exact == 0) continue;
      const Vector3d ray = view_.Ray(column, row);
      const double cosine =
          std::abs(NearestOn(w.solids[w.seen[pixel]], exact * ray).normal.dot(ray)) / ray.norm();
      double z = exact;
      // Beyond 60° the angle matters.
      const double sigma = noise_.Deviation(z, cosine < 0.5 ? std::acos(cosine) : 0);
      if (sigma > 0) z += sigma * random.Normal(pixel);
      z = noise_.Rounded(z);
      const bool reads = cosine >= flattest && z >= nearest_ && z <= farthest_;
      out.depth[pixel] = reads ? static_cast<float>(z) : 0.0f;
    }
}

}  // namespace pliant
