#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pliant/controllers/compliance_qp.h"
#include "pliant/controllers/external_acceleration.h"
#include "pliant/controllers/frame_task.h"
#include "pliant/controllers/joint_damper.h"
#include "pliant/controllers/posture_task.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {

/// The mid-level controller of EC (3)–(10), its state and external torque given by hand:
///
///   q, q̇ ─▶ dynamics ─▶ pose, posture, damper ─▶ qp
///   τ̂_e ─▶ external ─▶ pose, posture;  τ̂_e ─▶ qp
///   rows ─▶ qp
struct ComplianceRig {
  ComplianceRig(const RobotModel& m, const std::string& tool, bool damped = true,
                const std::vector<AccelerationRows>& all_rows = {})
      : ComplianceRig({.model = m,
                       .frame = tool,
                       .target = {{0.4, 0.1, 0.5}},
                       .stiffness = TaskVector::Constant(6, 400),
                       .damping = TaskVector::Constant(6, 40),
                       .weight = 1e4},
                      damped, all_rows) {}

  explicit ComplianceRig(const FrameTask::Options& task, bool damped = true,
                         const std::vector<AccelerationRows>& all_rows = {})
      : model{task.model} {
    const RobotModel& m = model;
    const Joints& joints = m.joints();
    DiagramBuilder b;
    q = &b.Add<Constant<JointPosition>>("q",
                                        {.space = joints, .value = JointPosition::Zero(joints)});
    v = &b.Add<Constant<JointVelocity>>("v",
                                        {.space = joints, .value = JointVelocity::Zero(joints)});
    tau_e = &b.Add<Constant<JointTorque>>("tau_e",
                                          {.space = joints, .value = JointTorque::Zero(joints)});
    dynamics = &b.Add<ModelDynamics>("dynamics", {.model = m});
    external = &b.Add<ExternalAcceleration>("external", {.joints = joints});
    pose = &b.Add<FrameTask>("pose", task);
    posture = &b.Add<PostureTask>("posture", {.model = m,
                                              .target = JointPosition::Zero(joints),
                                              .stiffness = PerJoint::Constant(m.size(), 1),
                                              .damping = PerJoint::Constant(m.size(), 5)});
    damper = &b.Add<JointDamper>("damper", {.model = m});
    int count = 0;
    for (const AccelerationRows& r : all_rows) count += static_cast<int>(r.lower.size());
    qp = &b.Add<ComplianceQp>("qp", {.model = m, .period = 1ms, .rows = count});
    for (const AccelerationRows& r : all_rows) {
      rows.push_back(&b.Add<Constant<AccelerationRows>>("rows_" + std::to_string(rows.size()),
                                                        {.space = joints, .value = r}));
      b.Connect(rows.back()->y, qp->rows);
    }
    b.Connect(q->y, dynamics->position);
    b.Connect(v->y, dynamics->velocity);
    b.Connect(dynamics->dynamics, external->dynamics);
    b.Connect(tau_e->y, external->external_torque);
    b.Connect(dynamics->dynamics, pose->dynamics);
    b.Connect(external->acceleration, pose->external_acceleration);
    b.Connect(dynamics->dynamics, posture->dynamics);
    b.Connect(external->acceleration, posture->external_acceleration);
    b.Connect(dynamics->dynamics, damper->dynamics);
    b.Connect(dynamics->dynamics, qp->dynamics);
    b.Connect(tau_e->y, qp->external_torque);
    b.Connect(pose->objective, qp->objectives);
    b.Connect(posture->objective, qp->objectives);
    if (damped) b.Connect(damper->bounds, qp->bounds);
    diagram = std::make_unique<Diagram>(b.Build());
    sim = std::make_unique<Simulator>(*diagram);
  }

  void SetState(const JointPosition& position, const JointVelocity& velocity) {
    sim->Set(q->value, position);
    sim->Set(v->value, velocity);
  }
  /// Γ of the pose and of the posture task.
  void SetCompliance(double pose_gamma, double posture_gamma) {
    const int n = model.size();
    const Eigen::Index rows = sim->Get(pose->error).size();
    sim->Set(pose->compliance, pose_gamma * TaskMatrix::Identity(rows, rows));
    sim->Set(posture->compliance, posture_gamma * JointMatrix::Identity(n, n));
  }
  /// One tick at this τ̂_e.
  void Tick(const JointTorque& torque) {
    sim->Set(tau_e->value, torque);
    sim->AdvanceThroughTick();
  }
  const RobotDynamics& d() { return sim->Get(dynamics->dynamics); }
  JointTorque torque() { return sim->Get(qp->torque); }
  JointAcceleration acceleration() { return sim->Get(qp->acceleration); }
  const ComplianceQpReport& report() { return sim->Get(qp->report); }

  RobotModel model;
  Constant<JointPosition>* q;
  Constant<JointVelocity>* v;
  Constant<JointTorque>* tau_e;
  ModelDynamics* dynamics;
  ExternalAcceleration* external;
  FrameTask* pose;
  PostureTask* posture;
  JointDamper* damper;
  ComplianceQp* qp;
  std::vector<Constant<AccelerationRows>*> rows;
  std::unique_ptr<Diagram> diagram;
  std::unique_ptr<Simulator> sim;
};

/// Both arms of the papers, with a link to hold at their ends.
struct Arm {
  std::string name;
  RobotModel model;
  std::string tool;
};
inline std::vector<Arm> Arms() {
  return {{"gen3", Gen3(), "tool_frame"}, {"lwr", Lwr(), "end_effector_link"}};
}

}  // namespace pliant
