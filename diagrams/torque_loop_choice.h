#pragma once

#include <string>
#include <variant>

#include "pliant/controllers/kinova_torque.h"
#include "pliant/controllers/low_level_torque.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// LowLevelTorque, and which of its parts are on.
struct ProposedTorqueLoop {
  static constexpr const char* kTag = "Proposed";

  double lag_gain = 5;                ///< λ; 0: without
  double leak_gain = 10;              ///< K_I; 0: without
  double leak_time_s = 2;             ///< θ
  double velocity_threshold = 0.1;    ///< q̇_th [rad/s]
  double acceleration_threshold = 1;  ///< q̈_th [rad/s²]
  bool friction = true;               ///< the compensation of friction
  bool rotor_feedforward = true;      ///< B q̈_d

  template <class F>
  void Parameters(F&& f) {
    f("lag_gain", lag_gain, "", kNotNegative);
    f("leak_gain", leak_gain, "", kNotNegative);
    f("leak_time_s", leak_time_s, "s", kPositive);
    f("velocity_threshold", velocity_threshold, "rad/s", kPositive);
    f("acceleration_threshold", acceleration_threshold, "rad/s²", kPositive);
    f("friction", friction);
    f("rotor_feedforward", rotor_feedforward);
  }
};

/// KinovaHighVelocityTorque. What is not published is to be given.
struct KinovaHighVelocityLoop {
  static constexpr const char* kTag = "KinovaHighVelocity";

  double feedforward = kToBeGiven;  ///< f
  double gain = kToBeGiven;         ///< k

  template <class F>
  void Parameters(F&& f) {
    f("feedforward", feedforward, "", kNotNegative);
    f("gain", gain, "", kNotNegative);
  }
};

/// KinovaDampedTorque. What is not published is to be given.
struct KinovaDampedLoop {
  static constexpr const char* kTag = "KinovaDamped";

  double feedforward = kToBeGiven;  ///< f
  double gain = kToBeGiven;         ///< k
  double damping = kToBeGiven;      ///< d [N·m·s/rad]

  template <class F>
  void Parameters(F&& f) {
    f("feedforward", feedforward, "", kNotNegative);
    f("gain", gain, "", kNotNegative);
    f("damping", damping, "N·m·s/rad", kNotNegative);
  }
};

/// What makes currents of torques.
using TorqueLoopChoice = std::variant<ProposedTorqueLoop, KinovaHighVelocityLoop, KinovaDampedLoop>;

/// Such as "torque loop of the RSS paper" or "Kinova's high-velocity torque loop, f = 0, k = 20".
std::string TorqueLoopText(const TorqueLoopChoice& choice);

/// The proposed loop of these motors, with the gains of the choice.
LowLevelTorque::Options TorqueLoopOf(const LowLevelTorque::Options& motors,
                                     const ProposedTorqueLoop& choice);

/// Kinova's loops of the same motors: figures and limits are theirs, gains those of the choice.
KinovaHighVelocityTorque::Options TorqueLoopOf(const LowLevelTorque::Options& motors,
                                               const KinovaHighVelocityLoop& choice);
KinovaDampedTorque::Options TorqueLoopOf(const LowLevelTorque::Options& motors,
                                         const KinovaDampedLoop& choice);

}  // namespace pliant
