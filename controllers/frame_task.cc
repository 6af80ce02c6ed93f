#include "pliant/controllers/frame_task.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

int Rows(FrameTask::Part part) { return part == FrameTask::Part::Pose ? 6 : 3; }

TaskVector Checked(const std::string& name, const TaskVector& x, std::string_view unit, int rows) {
  Require(x.size() == rows, name + " has " + Text(rows) + " elements", x.size());
  RequireEachInRange(name, x, unit, kNotNegative);
  return x;
}

TaskMatrix CheckedCompliance(const TaskMatrix& gamma, int rows) {
  if (gamma.size() == 0) return TaskMatrix::Zero(rows, rows);
  RequireCompliance(gamma, rows);
  return gamma;
}

Pose Checked(const Pose& X) {
  Require(X.position.allFinite(), "target position must be finite", X.position.transpose());
  const Eigen::Matrix3d& R = X.rotation;
  // A rotation that was written down with nine digits passes.
  Require((R * R.transpose()).isIdentity(1e-8) && R.determinant() > 0,
          "target rotation must be a rotation: R Rᵀ = I, det R = 1, got\n" + Text(R));
  return X;
}

/// log of a rotation as a vector: the axis times the angle.
Eigen::Vector3d Log(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

}  // namespace

FrameTask::FrameTask(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      external_acceleration{this, "external_acceleration", o.model.joints(),
                            JointAcceleration::Zero(o.model.joints())},
      target{this, "target", {}, Checked(o.target)},
      target_twist{this, "target_twist", {}, Twist{}},
      target_acceleration{this, "target_acceleration", {}, Twist{}},
      stiffness{this, "stiffness", {}, Checked("stiffness", o.stiffness, "1/s²", Rows(o.part))},
      damping{this, "damping", {}, Checked("damping", o.damping, "1/s", Rows(o.part))},
      weight{this, "weight", {}, o.weight},
      compliance{this, "compliance", {}, CheckedCompliance(o.compliance, Rows(o.part))},
      frame{this,
            "frame",
            {},
            PointDynamics(o.model, RobotDynamics(o.model), o.model.link_index(o.frame), {0, 0, 0})},
      error{this, "error", {}, TaskVector::Zero(Rows(o.part))},
      error_rate{this, "error_rate", {}, TaskVector::Zero(Rows(o.part))},
      objective{this, "objective", o.model.joints(), Objective::Zero(Rows(o.part), o.model.size())},
      model_{o.model},
      link_{o.model.link_index(o.frame)},
      first_{o.part == Part::Position ? 3 : 0},
      rows_{Rows(o.part)} {
  Require(o.weight > 0 && std::isfinite(o.weight), "weight must be finite and > 0", o.weight);
  Compute(frame).From(dynamics).As(&FrameTask::Find);
  Compute(error).From(frame, target).As(&FrameTask::Error);
  Compute(error_rate).From(frame, target_twist).As(&FrameTask::ErrorRate);
  Compute(objective)
      .From(frame, external_acceleration, error, error_rate, target_acceleration, stiffness,
            damping, weight, compliance)
      .As(&FrameTask::Want);
}

FrameDynamics FrameTask::Find(const RobotDynamics& d) const {
  return PointDynamics(model_, d, link_, {0, 0, 0});
}

TaskVector FrameTask::Error(const FrameDynamics& now, const Pose& X) const {
  Vector6 e;
  e << Log(now.pose.rotation * X.rotation.transpose()), now.pose.position - X.position;
  return e.segment(first_, rows_);
}

TaskVector FrameTask::ErrorRate(const FrameDynamics& now, const Twist& V) const {
  const Vector6 rate = now.twist - V;
  return rate.segment(first_, rows_);
}

void FrameTask::Want(Objective& out, const FrameDynamics& now, const JointAcceleration& qdd_e,
                     const TaskVector& e, const TaskVector& edot, const Twist& feedforward,
                     const TaskVector& k, const TaskVector& c, double w,
                     const TaskMatrix& gamma) const {
  out.A = now.J.middleRows(first_, rows_);
  const TaskVector pushed = out.A.lazyProduct(qdd_e);
  out.b = feedforward.segment(first_, rows_) - now.Jdot_v.segment(first_, rows_) -
          c.cwiseProduct(edot) - k.cwiseProduct(e);
  out.b.noalias() += gamma.lazyProduct(pushed);
  out.weight = w;
}

}  // namespace pliant
