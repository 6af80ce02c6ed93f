#include "pliant/diagrams/torque_loop_choice.h"

namespace pliant {

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
