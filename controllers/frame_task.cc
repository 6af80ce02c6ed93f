#include "pliant/controllers/frame_task.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "pliant/controllers/bounded_inertia.h"
#include "pliant/controllers/rotation.h"
#include "pliant/systems/elements.h"

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TaskVector Checked(const std::string& name, const TaskVector& x, std::string_view unit,
                   Eigen::Index rows) {
  Require(x.size() == rows, name + " has " + Text(rows) + " elements", x.size());
  RequireEachInRange(name, x, unit, kNotNegative);
  return x;
}

void RequireRotation(const std::string& name, const Matrix3d& R) {
  // A rotation that was written down with nine digits passes.
  Require((R * R.transpose()).isIdentity(1e-8) && R.determinant() > 0,
          name + " must be a rotation: R Rᵀ = I, det R = 1, got\n" + Text(R));
}

Pose Checked(const Pose& X) {
  Require(X.position.allFinite(), "target position must be finite", X.position.transpose());
  RequireRotation("target rotation", X.rotation);
  return X;
}

/// Γ or Y in the axes of the task.
TaskMatrix CheckedCompliance(const FrameTask::Options& o, const TaskMatrix& given,
                             Eigen::Index rows, std::string_view name, std::string_view symbol) {
  RequireRotation("compliance_axes", o.compliance_axes);
  const TaskMatrix gamma = ComplianceOf<TaskMatrix>(given, rows, name, symbol);
  return o.compliance_axes.isIdentity(0) ? gamma : InAxes(o.compliance_axes, gamma);
}

int PartRows(FrameTask::Part part) { return part == FrameTask::Part::Pose ? 6 : 3; }

/// The axis of the one turn that the rows leave free; 0 if there is none or are several.
Vector3d FreeTurn(const Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, 6>>& S) {
  if (S.rows() == 0) return Vector3d::Zero();
  const Matrix3d seen = S.leftCols<3>().transpose() * S.leftCols<3>();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(seen);
  constexpr double kNothing = 1e-8;  // rows may have been written down with nine digits
  if (eigen.eigenvalues()(0) > kNothing || eigen.eigenvalues()(1) <= kNothing)
    return Vector3d::Zero();
  return eigen.eigenvectors().col(0);
}

/// The shortest turn that takes one direction to another; opposite ones have many.
Vector3d ShortestTurn(const Vector3d& from, const Vector3d& to) {
  const Vector3d n = from.cross(to);
  const double sine = n.norm(), cosine = from.dot(to);
  if (sine > 0) return std::atan2(sine, cosine) / sine * n;
  return cosine < 0 ? Vector3d(std::numbers::pi * to.unitOrthogonal()) : Vector3d(Vector3d::Zero());
}

/// [Rᵀ x; Rᵀ y] of [x; y].
Vector6 Turned(const Matrix3d& R, const Vector6& x) {
  Vector6 turned;
  turned << R.transpose() * x.head<3>(), R.transpose() * x.tail<3>();
  return turned;
}

/// The motion of B as A sees it, in A's axes, of both in the world: with r from A to B
///
///   ω_AB = ω_B − ω_A,   v_AB = v_B − v_A − ω_A × r
///   ω̇_AB = α_B − α_A − ω_A × ω_B
///   v̇_AB = a_B − a_A − α_A × r − 2 ω_A × (v_B − v_A) + ω_A × (ω_A × r)
///
FrameDynamics Relative(const FrameDynamics& A, const FrameDynamics& B) {
  const Matrix3d to_A = A.pose.rotation.transpose();
  const Vector3d r = B.pose.position - A.pose.position;
  const Vector3d w = A.twist.head<3>(), v = B.twist.tail<3>() - A.twist.tail<3>();
  const Vector3d alpha = A.Jdot_v.head<3>();
  FrameDynamics X;
  X.link = B.link;
  X.pose = {to_A * r, to_A * B.pose.rotation};
  X.twist << to_A * (B.twist.head<3>() - w), to_A * (v - w.cross(r));
  X.Jdot_v << to_A * (B.Jdot_v.head<3>() - alpha - w.cross(Vector3d(B.twist.head<3>()))),
      to_A * (B.Jdot_v.tail<3>() - A.Jdot_v.tail<3>() - alpha.cross(r) - 2 * w.cross(v) +
              w.cross(w.cross(r)));
  X.J.resize(6, B.J.cols());
  for (Eigen::Index i = 0; i < X.J.cols(); ++i) {
    const Vector3d z = A.J.col(i).head<3>();
    X.J.col(i) << to_A * (B.J.col(i).head<3>() - z),
        to_A * (B.J.col(i).tail<3>() - A.J.col(i).tail<3>() - z.cross(r));
  }
  return X;
}

}  // namespace

FrameTask::FrameTask(const Options& o) : FrameTask(o, BasisOf(o)) {}

FrameTask::FrameTask(const Options& o, const Basis& S)
    : dynamics{this, "dynamics", o.model.joints()},
      external_acceleration{this, "external_acceleration", o.model.joints(),
                            JointAcceleration::Zero(o.model.joints())},
      target{this, "target", {}, Checked(o.target)},
      target_twist{this, "target_twist", {}, Twist{}},
      target_acceleration{this, "target_acceleration", {}, Twist{}},
      stiffness{this, "stiffness", {}, Checked("stiffness", o.stiffness, "1/s²", RowsOf(o, S))},
      damping{this, "damping", {}, Checked("damping", o.damping, "1/s", RowsOf(o, S))},
      weight{this, "weight", {}, o.weight},
      compliance{this,
                 "compliance",
                 {},
                 CheckedCompliance(o, o.compliance, RowsOf(o, S), "compliance", "Γ")},
      mobility{
          this, "mobility", {}, CheckedCompliance(o, o.mobility, RowsOf(o, S), "mobility", "Y")},
      frame{this,
            "frame",
            {},
            PointDynamics(o.model, RobotDynamics(o.model), o.model.link_index(o.frame), {0, 0, 0})},
      error{this, "error", {}, TaskVector::Zero(RowsOf(o, S))},
      error_rate{this, "error_rate", {}, TaskVector::Zero(RowsOf(o, S))},
      objective{this, "objective", o.model.joints(), Objective::Zero(RowsOf(o, S), o.model.size())},
      model_{o.model},
      link_{o.model.link_index(o.frame)},
      reference_{o.relative_to ? o.model.link_index(*o.relative_to) : -1},
      axes_{o.axes},
      S_{S},
      first_{o.part == Part::Position ? 3 : 0},
      rows_{RowsOf(o, S)},
      free_{o.axes == Axes::Frame ? FreeTurn(S) : Vector3d(Vector3d::Zero())},
      k0_{2 / o.inertia_limit} {
  Require(o.weight > 0 && std::isfinite(o.weight), "weight must be finite and > 0", o.weight);
  RequireInRange("", "inertia_limit", o.inertia_limit, "kg", kPositive);
  Compute(frame).From(dynamics).As(&FrameTask::Find);
  Compute(error).From(frame, target).As(&FrameTask::Error);
  Compute(error_rate).From(frame, target, target_twist).As(&FrameTask::ErrorRate);
  Compute(objective)
      .From(dynamics, frame, external_acceleration, target, target_twist, error, error_rate,
            target_acceleration, stiffness, damping, weight, compliance, mobility)
      .As(&FrameTask::Want);
}

/// S with six columns; without rows if all of the part is selected.
FrameTask::Basis FrameTask::BasisOf(const Options& o) {
  if (o.basis.size() == 0) return Basis(0, 6);
  const Eigen::Index columns = PartRows(o.part);
  TaskMatrix given = o.basis;
  if (given.cols() == 1 && given.rows() == columns) given = TaskMatrix(o.basis.transpose());
  Require(given.cols() == columns && given.rows() <= columns,
          "basis has up to " + Text(columns) + " rows of " + Text(columns) + " numbers",
          Text(given.rows()) + " x " + Text(given.cols()));
  Require(given.allFinite(), "basis must be finite");
  const Eigen::MatrixXd rows = given;
  const double deviation =
      (rows * rows.transpose() - Eigen::MatrixXd::Identity(rows.rows(), rows.rows()))
          .cwiseAbs()
          .maxCoeff();
  // Rows that were written down with nine digits pass.
  Require(deviation <= 1e-8, "basis must have orthonormal rows: |S Sᵀ − I| must be 0", deviation);
  Basis S = Basis::Zero(given.rows(), 6);
  S.middleCols(o.part == Part::Position ? 3 : 0, columns) = given;
  return S;
}

int FrameTask::RowsOf(const Options& o, const Basis& S) {
  return S.rows() > 0 ? static_cast<int>(S.rows()) : PartRows(o.part);
}

FrameDynamics FrameTask::Find(const RobotDynamics& d) const {
  if (reference_ < 0) return PointDynamics(model_, d, link_, {0, 0, 0});
  return Relative(PointDynamics(model_, d, reference_, {0, 0, 0}),
                  PointDynamics(model_, d, link_, {0, 0, 0}));
}

TaskVector FrameTask::Selected(const Vector6& x) const {
  if (S_.rows() > 0) return S_.lazyProduct(x);
  return x.segment(first_, rows_);
}

TaskVector FrameTask::Error(const FrameDynamics& now, const Pose& X) const {
  const Matrix3d& R = now.pose.rotation;
  Vector6 e;
  e << (free_.isZero(0) ? internal::Log(R * X.rotation.transpose())
                        : ShortestTurn(X.rotation * free_, R * free_)),
      now.pose.position - X.position;
  return Selected(axes_ == Axes::Frame ? Turned(R, e) : e);
}

TaskVector FrameTask::ErrorRate(const FrameDynamics& now, const Pose& X, const Twist& V) const {
  Vector6 rate = now.twist - V;
  if (axes_ == Axes::Frame) {
    const Vector3d w = now.twist.head<3>(), x = now.pose.position - X.position;
    rate.tail<3>() -= w.cross(x);
    rate = Turned(now.pose.rotation, rate);
  }
  return Selected(rate);
}

void FrameTask::Want(Objective& out, const RobotDynamics& d, const FrameDynamics& now,
                     const JointAcceleration& qdd_e, const Pose& X, const Twist& V,
                     const TaskVector& u, const TaskVector& udot, const Twist& feedforward,
                     const TaskVector& k, const TaskVector& c, double w, const TaskMatrix& gamma,
                     const TaskMatrix& Y) const {
  if (axes_ == Axes::Frame) {
    SelectInFrame(out, now, X, V, feedforward);
  } else if (S_.rows() > 0) {
    out.A = S_.lazyProduct(now.J);
    out.b = Selected(feedforward - now.Jdot_v);
  } else {
    out.A = now.J.middleRows(first_, rows_);
    out.b = feedforward.segment(first_, rows_) - now.Jdot_v.segment(first_, rows_);
  }
  const TaskVector pushed = out.A.lazyProduct(qdd_e);
  out.b -= c.cwiseProduct(udot) + k.cwiseProduct(u);
  out.b.noalias() += gamma.lazyProduct(pushed);
  // Without a trace a positive semi-definite matrix is 0; one that is no number is not left out.
  if (!(Y.trace() == 0)) out.b += AccelerationBy(Y, d, out, pushed);
  out.weight = w;
}

/// A and −c in the axes of B.
void FrameTask::SelectInFrame(Objective& out, const FrameDynamics& now, const Pose& X,
                              const Twist& V, const Twist& feedforward) const {
  const Matrix3d& R = now.pose.rotation;
  const Vector3d x = now.pose.position - X.position, xdot = now.twist.tail<3>() - V.tail<3>();
  const Vector3d w = now.twist.head<3>(), w0 = V.head<3>(), alpha = now.Jdot_v.head<3>();
  Vector6 bias = now.Jdot_v - feedforward;
  bias.head<3>() += w.cross(w0);
  bias.tail<3>() += w.cross(w.cross(x)) - 2 * w.cross(xdot) - alpha.cross(x);
  out.b = -Selected(Turned(R, bias));
  for (Eigen::Index i = 0; i < now.J.cols(); ++i) {
    Vector6 column = now.J.col(i);
    column.tail<3>() += x.cross(Vector3d(column.head<3>()));
    out.A.col(i) = Selected(Turned(R, column));
  }
}

/// Y Λ A q̈_e.
TaskVector FrameTask::AccelerationBy(const TaskMatrix& Y, const RobotDynamics& d,
                                     const Objective& out, const TaskVector& pushed) const {
  const Eigen::LLT<JointMatrix> M(d.M);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, 6> root =
      out.A.transpose();
  M.matrixL().solveInPlace(root);  // A M⁻¹ Aᵀ = rootᵀ root
  // Of six rows always: those there are not stay by themselves.
  Eigen::Matrix<double, 6, 6> K = Eigen::Matrix<double, 6, 6>::Identity();
  K.topLeftCorner(rows_, rows_) = root.transpose().lazyProduct(root);
  Vector6 x = Vector6::Zero();
  x.head(rows_) = pushed;
  const Vector6 force = internal::BoundedInertia(K, x, k0_);
  return Y.lazyProduct(force.head(rows_));
}

}  // namespace pliant
