#pragma once

#include "pliant/plants/actuator_parameters.h"
#include "pliant/plants/arm_status.h"
#include "pliant/systems/block.h"

namespace pliant {

/// The motors of an arm with their current loops, which sample their command every h: that of tick
/// k acts from tick k to tick k + 1,
///
///   θ di/dt = clamp(i_command, ± i_max) − i,   τ_m = clamp(η K_T G_r i, ± τ_max)
///
/// solved exactly: with c the clamped command of the last tick and i_k the current at it,
///
///   i(t) = c + (i_k − c) exp(−(t − t_k)/θ),   θ = 0: i = c
///
/// The loops are at rest at first, or at `current`.
class MotorDrive final : public Block {
 public:
  struct Options {
    Joints joints;
    std::vector<ActuatorParameters> parameters;  ///< of each joint
    MotorCurrent current = {};                   ///< i at the start; empty: 0
    Duration period = 1ms;                       ///< h
  };

  explicit MotorDrive(const Options& o);

  Input<MotorCurrent> command;
  Output<MotorCurrent> current;  ///< i
  Output<JointTorque> torque;    ///< τ_m, behind the gear
  Output<JointBits> saturated;   ///< joints whose command or torque is cut

 private:
  struct Start {
    MotorCurrent i, c;  // at the last tick: flowing, commanded
    double t = 0;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("i", i, "A");
      f("c", c, "A");
      f("t", t, "s");
    }
  };

  static Start AtRest(const Options& o);
  MotorCurrent Flow(double t, const Start& start) const;
  JointTorque Turn(const MotorCurrent& i) const;
  JointBits Cut(const Start& start, const MotorCurrent& i) const;

  const PerJoint i_max_, tau_max_, theta_, per_ampere_;
  Discrete<Start> start_;
};

}  // namespace pliant
