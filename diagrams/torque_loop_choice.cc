#include "pliant/diagrams/torque_loop_choice.h"

namespace pliant {

namespace {

std::string TextOf(const ProposedTorqueLoop& loop) {
  const ProposedTorqueLoop paper;
  std::string text = "torque loop of the RSS paper";
  if (loop.lag_gain != paper.lag_gain) text += ", λ = " + Text(loop.lag_gain);
  if (loop.leak_gain != paper.leak_gain) text += ", K_I = " + Text(loop.leak_gain);
  if (loop.leak_time_s != paper.leak_time_s) text += ", θ = " + Text(loop.leak_time_s) + " s";
  if (!loop.friction) text += ", without compensation of friction";
  if (!loop.rotor_feedforward) text += ", without feedforward of the rotors";
  return text;
}

std::string TextOf(const KinovaHighVelocityLoop& loop) {
  return "Kinova's high-velocity torque loop, f = " + Text(loop.feedforward) +
         ", k = " + Text(loop.gain);
}

std::string TextOf(const KinovaDampedLoop& loop) {
  return "Kinova's damped torque loop, f = " + Text(loop.feedforward) + ", k = " + Text(loop.gain) +
         ", d = " + Text(loop.damping) + " N·m·s/rad";
}

}  // namespace

std::string TorqueLoopText(const TorqueLoopChoice& choice) {
  return std::visit([](const auto& loop) { return TextOf(loop); }, choice);
}

LowLevelTorque::Options TorqueLoopOf(const LowLevelTorque::Options& motors,
                                     const ProposedTorqueLoop& choice) {
  LowLevelTorque::Options o = motors;
  o.lag_gain = choice.lag_gain;
  o.leak_gain = choice.leak_gain;
  o.leak_time_s = choice.leak_time_s;
  o.friction.velocity_threshold = choice.velocity_threshold;
  o.friction.acceleration_threshold = choice.acceleration_threshold;
  o.friction_feedforward = choice.friction;
  o.rotor_feedforward = choice.rotor_feedforward;
  return o;
}

KinovaHighVelocityTorque::Options TorqueLoopOf(const LowLevelTorque::Options& motors,
                                               const KinovaHighVelocityLoop& choice) {
  return {.joints = motors.joints,
          .torque_per_ampere = motors.torque_per_ampere,
          .reflected_inertia = motors.reflected_inertia,
          .current_limit = motors.current_limit,
          .feedforward = choice.feedforward,
          .gain = choice.gain,
          .period = motors.period};
}

KinovaDampedTorque::Options TorqueLoopOf(const LowLevelTorque::Options& motors,
                                         const KinovaDampedLoop& choice) {
  const KinovaHighVelocityLoop loop{.feedforward = choice.feedforward, .gain = choice.gain};
  return {.torque = TorqueLoopOf(motors, loop), .damping = choice.damping};
}

}  // namespace pliant
