#pragma once

#include <memory>

#include "pliant/diagrams/simulated_arm.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/push.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/recorder.h"
#include "spring_hold.h"

// shown: begin diagram
/// An arm that holds its posture by a damped spring while it is pushed, and a log of it.
///
///   arm.measured_… ─▶ model ─▶ spring ─▶ arm.torque_command
///   push ─▶ arm.contacts
struct HeldArm {
  pliant::SimulatedArm& arm;
  pliant::Diagram diagram;
};

inline HeldArm MakeHeldArm(const pliant::SimulatedArm::Options& station,
                           const SpringHold::Options& law, const pliant::Push::Options& force,
                           const std::shared_ptr<pliant::RecordSink>& log) {
  using namespace pliant;
  DiagramBuilder b;
  auto& arm = b.Add<SimulatedArm>("arm", station);
  auto& model = b.Add<ModelDynamics>("model", {.model = station.model});
  auto& spring = b.Add<SpringHold>("spring", law);
  auto& push = b.Add<Push>("push", force);
  auto& recorder = b.Add<Recorder>("recorder", {.period = 1ms, .sink = log});

  b.Connect(arm.measured_position, model.position);
  b.Connect(arm.measured_velocity, model.velocity);
  b.Connect(model.dynamics, spring.dynamics);
  b.Connect(spring.torque, arm.torque_command);
  b.Connect(push.force, arm.contacts);

  b.Connect(arm.measured_position, recorder.in);
  b.Connect(arm.measured_velocity, recorder.in);
  b.Connect(arm.measured_torque, recorder.in);
  b.Connect(spring.torque, recorder.in);
  b.Connect(push.force, recorder.in);
  return {arm, b.Build()};
}
// shown: end diagram
