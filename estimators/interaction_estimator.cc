#include "pliant/estimators/interaction_estimator.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

InteractionEstimator::Memory InteractionEstimator::Blank(const Options& o) {
  const Joints& joints = o.model.joints();
  const int m = o.at ? 3 : o.model.size();
  return {.R = o.prior * JointMatrix::Identity(m, m),
          .z = PerJoint::Zero(m),
          .theta = PerJoint::Zero(m),
          .estimate = JointTorque::Zero(joints),
          .p = JointMomentum::Zero(joints),
          .beta = JointTorque::Zero(joints)};
}

InteractionEstimator::InteractionEstimator(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      external_torque{this, "external_torque", o.model.joints()},
      information{this, "information", {}, Blank(o).R},
      model_{o.model},
      link_{o.at ? o.model.link_index(o.at->link) : -1},
      point_{o.at ? o.at->point : Eigen::Vector3d::Zero()},
      B_{EachInRangeOr0("rotor_inertia", o.rotor_inertia, "kg·m²", kNotNegative, o.model.joints())},
      h_{seconds(o.period)},
      lambda_{std::exp(-seconds(o.period) / o.memory_s)},
      prior_{o.prior},
      memory_{this, "memory", o.model.joints(), Blank(o)} {
  RequireInRange("", "memory_s", o.memory_s, "s", kPositive);
  RequireInRange("", "prior", o.prior, "", kPositive);
  Require(point_.allFinite(), "at.point must be finite", point_.transpose());
  Every(o.period).Compute(memory_).From(memory_, dynamics, torque).As(&InteractionEstimator::Next);
  Compute(external_torque).From(memory_).As([](const Memory& m) { return m.estimate; });
  Compute(information).From(memory_).As([](const Memory& m) { return m.R; });
  if (o.at)
    Compute(force).From(memory_).As([](const Memory& m) { return Force(m.theta.head<3>()); });
  else
    Compute(force).From().As([] { return Force(); });
}

InteractionEstimator::Memory InteractionEstimator::Next(const Memory& last, const RobotDynamics& d,
                                                        const JointTorque& tau) const {
  Memory now = last;
  const JointMomentum p = d.p - B_.cwiseProduct(d.v);
  const JointTorque beta = d.coriolis_transposed - d.gravity;
  if (last.started) {
    const PerJoint y = (p - last.p) / h_ - tau - 0.5 * (beta + last.beta);
    now.R = lambda_ * last.R;
    now.R.diagonal().array() += (1 - lambda_) * prior_;
    if (link_ < 0) {
      now.R.diagonal().array() += 1;
      now.z = lambda_ * last.z + y;
      now.theta = now.R.llt().solve(now.z);
      now.estimate = now.theta;
    } else {
      const Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJoints> J =
          PointDynamics(model_, d, link_, point_).J.bottomRows<3>();
      now.R += J.lazyProduct(J.transpose());
      now.z = lambda_ * last.z + J.lazyProduct(y);
      const Eigen::Matrix3d R = now.R;
      const Eigen::Vector3d z = now.z;
      const Eigen::Vector3d theta = R.llt().solve(z);
      now.theta = theta;
      now.estimate = J.transpose().lazyProduct(theta);
    }
  }
  now.p = p;
  now.beta = beta;
  now.started = true;
  return now;
}

}  // namespace pliant
