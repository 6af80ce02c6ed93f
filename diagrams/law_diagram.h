#pragma once

#include <functional>
#include <memory>

#include "pliant/diagrams/scenario.h"

namespace pliant {

/// A law of torques as a function, called at every tick:
///
///   τ_k = f(t_k, q_k, v_k, τ_m,k)
///
/// of what the arm measures. What it throws leaves Simulator::AdvanceTo as it is. A function that
/// remembers, or that waits, is no rule: snapshots do not hold its memory, and no arm that is there
/// should wait for it.
class TorqueLaw final : public Block {
 public:
  using Function = std::function<JointTorque(double t, const JointPosition&, const JointVelocity&,
                                             const JointTorque&)>;

  struct Options {
    Joints joints;
    Function function;
    Duration period;
  };

  explicit TorqueLaw(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  Output<JointTorque> torque;

 private:
  JointTorque Call(double t, const JointPosition& q, const JointVelocity& v,
                   const JointTorque& tau) const;

  const Joints joints_;
  const Function function_;
};

/// The simulated arm and the environment of a scenario, with a function in the place of its
/// controller:
///
///   environment, load ─▶ arm ─▶ control ─▶ arm
///
/// The arm is in torque mode and takes the whole torque, that of its weight included; one whose
/// motors are not ideal does with it what its firmware does. `load.value` is a torque of the
/// environment on the joints, zero until it is set. What `sink` gets, if there is one: measurements
/// and truth of the arm, contacts, the torque of the law, true torques.
struct LawDiagram {
  LawDiagram(const Scenario& scenario, TorqueLaw::Function law,
             std::shared_ptr<RecordSink> sink = {});

  DiagramBuilder builder;
  SimulatedArm* arm;
  TorqueLaw* control;
  Duration control_period;
};

}  // namespace pliant
