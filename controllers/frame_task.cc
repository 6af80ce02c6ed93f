#include "pliant/controllers/frame_task.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace pliant {

namespace {

int FrameIndex(const FrameTask::Options& o) {
  const auto found = std::ranges::find(o.frames, o.frame);
  Require(found != o.frames.end(), "frame must be one of the frames of the dynamics", o.frame);
  return static_cast<int>(found - o.frames.begin());
}

int Rows(FrameTask::Part part) { return part == FrameTask::Part::Pose ? 6 : 3; }

TaskVector Checked(const TaskVector& x, int rows, const std::string& name) {
  Require(x.size() == rows, name + " has " + Text(rows) + " elements", x.size());
  Require(x.allFinite() && x.minCoeff() >= 0, "every " + name + " must be >= 0", x.transpose());
  return x;
}

TaskMatrix CheckedCompliance(const TaskMatrix& gamma, int rows) {
  if (gamma.size() == 0) return TaskMatrix::Zero(rows, rows);
  RequireCompliance(gamma, rows);
  return gamma;
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
      target{this, "target", {}, o.target},
      target_twist{this, "target_twist", {}, Twist{}},
      target_acceleration{this, "target_acceleration", {}, Twist{}},
      stiffness{this, "stiffness", {}, Checked(o.stiffness, Rows(o.part), "stiffness")},
      damping{this, "damping", {}, Checked(o.damping, Rows(o.part), "damping")},
      weight{this, "weight", {}, o.weight},
      compliance{this, "compliance", {}, CheckedCompliance(o.compliance, Rows(o.part))},
      error{this, "error", {}, TaskVector::Zero(Rows(o.part))},
      error_rate{this, "error_rate", {}, TaskVector::Zero(Rows(o.part))},
      objective{this, "objective", o.model.joints(), Objective::Zero(Rows(o.part), o.model.size())},
      index_{FrameIndex(o)},
      first_{o.part == Part::Position ? 3 : 0},
      rows_{Rows(o.part)} {
  Require(o.weight > 0, "weight must be > 0", o.weight);
  Compute(error).From(dynamics, target).As(&FrameTask::Error);
  Compute(error_rate).From(dynamics, target_twist).As(&FrameTask::ErrorRate);
  Compute(objective)
      .From(dynamics, external_acceleration, error, error_rate, target_acceleration, stiffness,
            damping, weight, compliance)
      .As(&FrameTask::Want);
}

TaskVector FrameTask::Error(const RobotDynamics& d, const Pose& X) const {
  const Pose& now = d.frame[static_cast<std::size_t>(index_)].pose;
  Vector6 e;
  e << Log(now.rotation * X.rotation.transpose()), now.position - X.position;
  return e.segment(first_, rows_);
}

TaskVector FrameTask::ErrorRate(const RobotDynamics& d, const Twist& V) const {
  const Vector6 rate = d.frame[static_cast<std::size_t>(index_)].twist - V;
  return rate.segment(first_, rows_);
}

void FrameTask::Want(Objective& out, const RobotDynamics& d, const JointAcceleration& qdd_e,
                     const TaskVector& e, const TaskVector& edot, const Twist& feedforward,
                     const TaskVector& k, const TaskVector& c, double w,
                     const TaskMatrix& gamma) const {
  const FrameDynamics& frame = d.frame[static_cast<std::size_t>(index_)];
  const auto J = frame.J.middleRows(first_, rows_);
  const TaskVector pushed = J * qdd_e;
  out.A = J;
  out.b = feedforward.segment(first_, rows_) - frame.Jdot_v.segment(first_, rows_) -
          c.cwiseProduct(edot) - k.cwiseProduct(e);
  out.b.noalias() += gamma * pushed;
  out.weight = w;
}

}  // namespace pliant
