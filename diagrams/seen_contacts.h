#pragma once

#include "pliant/estimators/contact_localization.h"
#include "pliant/plants/depth_camera.h"

namespace pliant {

/// Where the arm is touched is seen by a depth camera: 1.7 m behind the arm and 1.1 m above its
/// base, as in Magrini, Flacco & De Luca 2015 (CF), V. What it looks at is not published.
struct SeenContacts {
  static constexpr const char* kTag = "DepthCamera";

  Eigen::Vector3d position{1.7, 0, 1.1};  ///< of the camera [m]
  Eigen::Vector3d target{-0.2, 0, 0.5};   ///< in the middle of its picture [m]
  DepthNoise noise = {};
  double margin = 0.005;        ///< as ContactLocalization has it [m]
  double reach = 0.06;          ///< as ContactLocalization has it [m]
  int contacts = kMaxContacts;  ///< at most

  template <class F>
  void Parameters(F&& f) {
    f("position", position, "m");
    f("target", target, "m");
    f("noise", noise);
    f("margin", margin, "m", kNotNegative);
    f("reach", reach, "m", kPositive);
    f("contacts", contacts, "", Between(1, kMaxContacts));
  }
};

/// The camera, which sees `model`.
inline DepthCamera::Options CameraOf(const SeenContacts& seen, const RobotModel& model,
                                     std::uint64_t seed) {
  DepthCamera::Options camera{.model = model, .noise = seen.noise, .seed = seed};
  camera.view.pose = LookingAt(seen.position, seen.target);
  return camera;
}

/// What looks at its pictures, and takes `model` for the arm.
inline ContactLocalization::Options LocalizationOf(const SeenContacts& seen,
                                                   const RobotModel& model) {
  ContactLocalization::Options localization{.model = model, .noise = seen.noise};
  localization.view.pose = LookingAt(seen.position, seen.target);
  localization.margin = seen.margin;
  localization.reach = seen.reach;
  localization.contacts = seen.contacts;
  return localization;
}

}  // namespace pliant
