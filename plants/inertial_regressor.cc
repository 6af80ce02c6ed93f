#include "pliant/plants/inertial_regressor.h"

#include <Eigen/Geometry>
#include <array>

namespace pliant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using WrenchRegressor = Eigen::Matrix<double, 6, 10>;

std::size_t At(int i) { return static_cast<std::size_t>(i); }

/// What joint accelerations add to the motion of a body, in world axes.
struct Added {
  Vector3d alpha = Vector3d::Zero(), acceleration = Vector3d::Zero();
};

/// [a]: [a] b = a × b.
Matrix3d Cross(const Vector3d& a) {
  Matrix3d A;
  A << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return A;
}

/// L(a): L(a) (I_xx, I_xy, I_xz, I_yy, I_yz, I_zz) = I a.
Eigen::Matrix<double, 3, 6> InertiaTimes(const Vector3d& a) {
  Eigen::Matrix<double, 3, 6> L;
  L << a.x(), a.y(), a.z(), 0, 0, 0,  //
      0, a.x(), 0, a.y(), a.z(), 0,   //
      0, 0, a.x(), 0, a.y(), a.z();
  return L;
}

/// (n; f) = A π, all in the axes of the link.
WrenchRegressor MovingWrench(const Vector3d& omega, const Vector3d& alpha, const Vector3d& a) {
  const Matrix3d W = Cross(omega);
  WrenchRegressor A = WrenchRegressor::Zero();
  A.block<3, 3>(0, 1) = -Cross(a);
  A.block<3, 6>(0, 4) = InertiaTimes(alpha) + W * InertiaTimes(omega);
  A.block<3, 1>(3, 0) = a;
  A.block<3, 3>(3, 1) = Cross(alpha) + W * W;
  return A;
}

}  // namespace

void ComputeInertialRegressor(const RobotModel& model, const RobotDynamics& d,
                              const JointAcceleration& vdot, std::span<const int> links,
                              Eigen::Ref<Eigen::MatrixXd> Y) {
  const std::span<const Body> bodies = model.bodies();
  std::array<Added, kMaxJoints> added;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int parent = bodies[i].parent;
    const Vector3d z = d.body[i].rotation.col(2);
    if (parent >= 0) {
      const Added& base = added[At(parent)];
      const Vector3d r = d.body[i].position - d.body[At(parent)].position;
      added[i] = {base.alpha, base.acceleration + base.alpha.cross(r)};
    }
    (bodies[i].revolute ? added[i].alpha : added[i].acceleration) += vdot(bodies[i].joint) * z;
  }

  Y.setZero();
  for (std::size_t k = 0; k < links.size(); ++k) {
    const Link& link = model.link(links[k]);
    if (link.body < 0) continue;
    const BodyMotion& B = d.body[At(link.body)];
    const Vector3d r = B.rotation * link.pose.position;
    const Matrix3d R_LW = (B.rotation * link.pose.rotation).transpose();
    const Vector3d alpha = B.alpha + added[At(link.body)].alpha;
    const Vector3d a = B.acceleration + added[At(link.body)].acceleration + alpha.cross(r) +
                       B.omega.cross(B.omega.cross(r)) - model.gravity();
    const WrenchRegressor A = MovingWrench(R_LW * B.omega, R_LW * alpha, R_LW * a);
    for (int i = link.body; i >= 0; i = bodies[At(i)].parent) {
      const Body& body = bodies[At(i)];
      const Vector3d z = d.body[At(i)].rotation.col(2);
      Eigen::Matrix<double, 1, 6> S;  // the joint's twist at the link's origin
      if (body.revolute)
        S << (R_LW * z).transpose(),
            (R_LW * z.cross(B.position + r - d.body[At(i)].position)).transpose();
      else
        S << 0, 0, 0, (R_LW * z).transpose();
      Y.block<1, 10>(body.joint, 10 * static_cast<Eigen::Index>(k)).noalias() = S * A;
    }
  }
}

}  // namespace pliant
