#include "pliant/controllers/external_acceleration.h"

#include <Eigen/Cholesky>

namespace pliant {

ExternalAcceleration::ExternalAcceleration(const Options& o)
    : dynamics{this, "dynamics", o.joints},
      external_torque{this, "external_torque", o.joints, JointTorque::Zero(o.joints)},
      acceleration{this, "acceleration", o.joints} {
  Compute(acceleration)
      .From(dynamics, external_torque)
      .As([](const RobotDynamics& d, const JointTorque& tau_e) -> JointAcceleration {
        return d.M.llt().solve(tau_e);
      });
}

}  // namespace pliant
