#include "pliant/plants/model_dynamics.h"

namespace pliant {

ModelDynamics::ModelDynamics(const Options& o)
    : position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      dynamics{this, "dynamics", o.model.joints(), RobotDynamics(o.model, o.frames)},
      model_{o.model},
      B_{o.rotor_inertia} {
  Require(B_.size() == 0 || B_.size() == o.model.size(),
          "rotor_inertia has an element for each of the " + Text(o.model.size()) + " joints",
          B_.size());
  Require(B_.size() == 0 || (B_.allFinite() && B_.minCoeff() >= 0),
          "every rotor_inertia must be finite and >= 0", B_.transpose());
  Compute(dynamics).From(position, velocity).As(&ModelDynamics::At);
}

void ModelDynamics::At(RobotDynamics& d, const JointPosition& q, const JointVelocity& v) const {
  ComputeDynamics(model_, q, v, d);
  if (B_.size() == 0) return;
  d.M.diagonal() += B_;
  d.p += B_.cwiseProduct(v);
}

}  // namespace pliant
