#include "pliant/plants/robot_dynamics.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::size_t At(int i) { return static_cast<std::size_t>(i); }

/// A body and all it carries: mass, moments and sums about the body's origin, world axes.
struct Subtree {
  double m;       // mass
  Vector3d mc;    // first moment
  Matrix3d I;     // inertia
  Vector3d n, f;  // moment and force that make it move so at v̇ = 0
  Vector3d k, l;  // angular and linear momentum
};

void Move(const Body& body, const BodyMotion& base, double q, double v, BodyMotion& B) {
  const Matrix3d R = base.rotation * body.pose.rotation;
  const Vector3d z = R.col(2);
  Vector3d r = base.rotation * body.pose.position;
  if (body.revolute) {
    const double c = std::cos(q), s = std::sin(q);
    B.rotation.col(0) = c * R.col(0) + s * R.col(1);
    B.rotation.col(1) = c * R.col(1) - s * R.col(0);
    B.rotation.col(2) = z;
  } else {
    B.rotation = R;
    r += q * z;
  }
  const Vector3d w_r = base.omega.cross(r);
  B.position = base.position + r;
  B.omega = base.omega;
  B.velocity = base.velocity + w_r;
  B.alpha = base.alpha;
  B.acceleration = base.acceleration + base.alpha.cross(r) + base.omega.cross(w_r);
  const Vector3d w_z = base.omega.cross(z);
  if (body.revolute) {
    B.omega += v * z;
    B.alpha += v * w_z;
  } else {
    B.velocity += v * z;
    B.acceleration += 2 * v * w_z;
  }
}

void Weigh(const Body& body, const BodyMotion& B, Subtree& s) {
  s.m = body.mass;
  s.mc.noalias() = B.rotation * body.moment;
  const Matrix3d RI = B.rotation * body.inertia;
  s.I.noalias() = RI * B.rotation.transpose();
  s.l = s.m * B.velocity + B.omega.cross(s.mc);
  const Vector3d Iw = s.I * B.omega;
  s.k = Iw + s.mc.cross(B.velocity);
  s.f = s.m * B.acceleration + B.alpha.cross(s.mc) + B.omega.cross(B.omega.cross(s.mc));
  s.n = s.I * B.alpha + B.omega.cross(Iw) + s.mc.cross(B.acceleration);
}

/// Adds `s`, whose origin is at `r` from that of `base`.
void Carry(const Subtree& s, const Vector3d& r, Subtree& base) {
  base.m += s.m;
  base.mc += s.mc + s.m * r;
  // −[r]² m − [r][mc] − [mc][r], with [a][b] = b aᵀ − (a·b) 1
  const Vector3d u = s.mc + s.m * r;
  base.I += s.I;
  base.I.noalias() -= u * r.transpose();
  base.I.noalias() -= r * s.mc.transpose();
  base.I.diagonal().array() += r.dot(u) + r.dot(s.mc);
  base.n += s.n + r.cross(s.f);
  base.f += s.f;
  base.k += s.k + r.cross(s.l);
  base.l += s.l;
}

void WriteFrame(const RobotModel& model, const RobotDynamics& d, const Link& link,
                const Vector3d& point, FrameDynamics& frame) {
  static const BodyMotion world;
  const BodyMotion& B = link.body < 0 ? world : d.body[At(link.body)];
  const std::span<const Body> bodies = model.bodies();
  const Vector3d r = B.rotation * (link.pose.position + link.pose.rotation * point);
  frame.pose.position = B.position + r;
  frame.pose.rotation.noalias() = B.rotation * link.pose.rotation;
  const Vector3d w_r = B.omega.cross(r);
  frame.twist.head<3>() = B.omega;
  frame.twist.tail<3>() = B.velocity + w_r;
  frame.Jdot_v.head<3>() = B.alpha;
  frame.Jdot_v.tail<3>() = B.acceleration + B.alpha.cross(r) + B.omega.cross(w_r);
  frame.J.setZero(6, model.size());
  for (int i = link.body; i >= 0; i = bodies[At(i)].parent) {
    const Vector3d z = d.body[At(i)].rotation.col(2);
    Jacobian::ColXpr column = frame.J.col(bodies[At(i)].joint);
    if (bodies[At(i)].revolute) {
      column.head<3>() = z;
      column.tail<3>() = z.cross(frame.pose.position - d.body[At(i)].position);
    } else {
      column.tail<3>() = z;
    }
  }
}

}  // namespace

RobotDynamics::RobotDynamics(const RobotModel& model, std::span<const std::string> names)
    : q{JointPosition::Zero(model.joints())},
      v{JointVelocity::Zero(model.joints())},
      M{JointMatrix::Zero(model.size(), model.size())},
      coriolis{JointTorque::Zero(model.joints())},
      coriolis_transposed{coriolis},
      gravity{coriolis},
      p{JointMomentum::Zero(model.joints())},
      frames{static_cast<int>(names.size())} {
  Require(frames <= kMaxFrames, "dynamics of at most " + Text(kMaxFrames) + " frames are computed",
          frames);
  for (std::size_t i = 0; i < names.size(); ++i) frame[i].link = model.link_index(names[i]);
  ComputeDynamics(model, q, v, *this);
}

void ComputeDynamics(const RobotModel& model, const JointPosition& q, const JointVelocity& v,
                     RobotDynamics& d) {
  static const BodyMotion world;
  const std::span<const Body> bodies = model.bodies();
  const int n = static_cast<int>(bodies.size());
  std::array<Subtree, kMaxJoints> subtree;

  for (int i = 0; i < n; ++i) {
    const Body& body = bodies[At(i)];
    Move(body, body.parent < 0 ? world : d.body[At(body.parent)], q(body.joint), v(body.joint),
         d.body[At(i)]);
    Weigh(body, d.body[At(i)], subtree[At(i)]);
  }

  for (int i = n - 1; i >= 0; --i) {
    const Subtree& s = subtree[At(i)];
    const BodyMotion& B = d.body[At(i)];
    const Vector3d z = B.rotation.col(2);
    const int row = bodies[At(i)].joint;
    const Vector3d w_z = B.omega.cross(z);
    Vector3d k, l;  // of the subtree moved by this joint alone at unit speed
    if (bodies[At(i)].revolute) {
      d.coriolis(row) = z.dot(s.n);
      d.gravity(row) = -z.dot(s.mc.cross(model.gravity()));
      d.p(row) = z.dot(s.k);
      d.coriolis_transposed(row) = s.k.dot(w_z) + s.l.dot(B.velocity.cross(z));
      k.noalias() = s.I * z;
      l = z.cross(s.mc);
      d.M(row, row) = z.dot(k);
    } else {
      d.coriolis(row) = z.dot(s.f);
      d.gravity(row) = -s.m * z.dot(model.gravity());
      d.p(row) = z.dot(s.l);
      d.coriolis_transposed(row) = s.l.dot(w_z);
      k = s.mc.cross(z);
      l = s.m * z;
      d.M(row, row) = s.m;
    }
    for (int child = i, j = bodies[At(i)].parent; j >= 0; child = j, j = bodies[At(j)].parent) {
      k += (d.body[At(child)].position - d.body[At(j)].position).cross(l);
      const int column = bodies[At(j)].joint;
      d.M(row, column) = d.body[At(j)].rotation.col(2).dot(bodies[At(j)].revolute ? k : l);
      d.M(column, row) = d.M(row, column);
    }
    if (const int j = bodies[At(i)].parent; j >= 0)
      Carry(s, B.position - d.body[At(j)].position, subtree[At(j)]);
  }

  d.q = q;
  d.v = v;
  for (int i = 0; i < d.frames; ++i) {
    FrameDynamics& frame = d.frame[At(i)];
    WriteFrame(model, d, model.link(frame.link), Vector3d::Zero(), frame);
  }
}

JointAcceleration ForwardDynamics(const RobotDynamics& d, const JointTorque& tau,
                                  const JointTorque& tau_e, const PerJoint& rotor_inertia) {
  // By hand: for matrices of this size Eigen's blocked factorization takes three times as long.
  const std::size_t n = static_cast<std::size_t>(d.M.rows());
  std::array<std::array<double, kMaxJoints>, kMaxJoints> L;  // below the diagonal
  std::array<double, kMaxJoints> inverse;                    // of the diagonal of L
  JointAcceleration a = tau + tau_e - d.coriolis - d.gravity;
  double* const x = a.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double s = d.M.data()[i * n + j];
      if (i == j && rotor_inertia.size() > 0) s += rotor_inertia.data()[i];
      for (std::size_t k = 0; k < j; ++k) s -= L[i][k] * L[j][k];
      if (j < i)
        L[i][j] = s * inverse[j];
      else if (s > 0)
        inverse[i] = 1 / std::sqrt(s);
      else
        return PerJoint::Constant(d.M.rows(), std::numeric_limits<double>::quiet_NaN());
    }
    for (std::size_t k = 0; k < i; ++k) x[i] -= L[i][k] * x[k];
    x[i] *= inverse[i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= L[k][i] * x[k];
    x[i] *= inverse[i];
  }
  return a;
}

JointTorque InverseDynamics(const RobotDynamics& d, const JointAcceleration& vdot) {
  return d.M.lazyProduct(vdot) + d.coriolis + d.gravity;
}

JointTorque ExternalTorque(const RobotModel& model, const RobotDynamics& d,
                           std::span<const ContactForce> forces) {
  const std::span<const Body> bodies = model.bodies();
  JointTorque tau_e = JointTorque::Zero(model.joints());
  for (const ContactForce& F : forces) {
    if (F.link < 0) continue;
    if (F.link >= static_cast<int>(model.links().size())) {
      tau_e.setConstant(std::numeric_limits<double>::quiet_NaN());
      return tau_e;
    }
    const Pose X_WL = LinkPose(model, d, F.link);
    const Vector3d point = X_WL.position + X_WL.rotation * F.point;
    for (int i = model.link(F.link).body; i >= 0; i = bodies[At(i)].parent) {
      const BodyMotion& B = d.body[At(i)];
      const Vector3d z = B.rotation.col(2);
      tau_e(bodies[At(i)].joint) += bodies[At(i)].revolute
                                        ? z.dot(F.moment + (point - B.position).cross(F.force))
                                        : z.dot(F.force);
    }
  }
  return tau_e;
}

Pose LinkPose(const RobotModel& model, const RobotDynamics& d, int index) {
  const Link& link = model.link(index);
  if (link.body < 0) return link.pose;
  const BodyMotion& B = d.body[At(link.body)];
  return Pose{B.position, B.rotation} * link.pose;
}

FrameDynamics PointDynamics(const RobotModel& model, const RobotDynamics& d, int link,
                            const Vector3d& point) {
  FrameDynamics frame;
  frame.link = link;
  WriteFrame(model, d, model.link(link), point, frame);
  return frame;
}

PointMotion MotionOf(const RobotModel& model, const RobotDynamics& d, int index,
                     const Vector3d& point) {
  const Link& link = model.link(index);
  const Vector3d in_body = link.pose.position + link.pose.rotation * point;
  if (link.body < 0) return {in_body, Vector3d::Zero()};
  const BodyMotion& B = d.body[At(link.body)];
  const Vector3d r = B.rotation * in_body;
  return {B.position + r, B.velocity + B.omega.cross(r)};
}

double KineticEnergy(const RobotDynamics& d) { return 0.5 * d.v.dot(d.M.lazyProduct(d.v)); }

double PotentialEnergy(const RobotModel& model, const RobotDynamics& d) {
  double U = 0;
  for (std::size_t i = 0; i < model.bodies().size(); ++i) {
    const Body& body = model.bodies()[i];
    const Vector3d mc = body.mass * d.body[i].position + d.body[i].rotation * body.moment;
    U -= mc.dot(model.gravity());
  }
  return U;
}

}  // namespace pliant
