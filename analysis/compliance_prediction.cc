#include "pliant/analysis/compliance_prediction.h"

#include <Eigen/Cholesky>
#include <unsupported/Eigen/MatrixFunctions>

#include "pliant/plants/robot_dynamics.h"

namespace pliant {

Series DeviationBehindObserver(const Series& a, double observer_gain, double damping,
                               double stiffness, Duration period) {
  Require(observer_gain > 0, "observer_gain must be > 0", observer_gain);
  // x = (low-passed a, e, ė), what is left of a after the observer's estimate drives e.
  Eigen::Matrix4d F = Eigen::Matrix4d::Zero();  // [A b; 0 0]
  F.row(0) << -observer_gain, 0, 0, observer_gain;
  F.row(1) << 0, 0, 1, 0;
  F.row(2) << -1, -stiffness, -damping, 1;
  const Eigen::Matrix4d step = (F * seconds(period)).exp();
  const Eigen::Matrix3d A = step.topLeftCorner<3, 3>();
  const Eigen::Vector3d b = step.topRightCorner<3, 1>();

  Series e(a.rows(), a.cols());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < a.cols(); ++k) {
      e(i, k) = x(1);
      x = (A * x + b * a(i, k)).eval();
    }
  }
  return e;
}

Series TaskAcceleration(const RobotModel& model, std::string_view frame, const Series& q,
                        const Series& tau_e, const PerJoint& rotor_inertia) {
  Require(q.rows() == model.size() && tau_e.rows() == model.size() && q.cols() == tau_e.cols(),
          "q and tau_e have a row per joint and a column per sample");
  RobotDynamics d(model, {std::string(frame)});
  Series a(6, q.cols());
  for (Eigen::Index k = 0; k < q.cols(); ++k) {
    ComputeDynamics(model, q.col(k), JointVelocity::Zero(model.joints()), d);
    if (rotor_inertia.size() > 0) d.M.diagonal() += rotor_inertia;
    const Eigen::VectorXd pushed = d.M.llt().solve(tau_e.col(k));
    a.col(k) = d.frame[0].J * pushed;
  }
  return a;
}

}  // namespace pliant
