#include "pliant/plants/model_dynamics.h"

#include "pliant/systems/elements.h"

namespace pliant {

ModelDynamics::ModelDynamics(const Options& o)
    : position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      dynamics{this, "dynamics", o.model.joints(), RobotDynamics(o.model, o.frames)},
      model_{o.model},
      B_{EachInRangeOr0("rotor_inertia", o.rotor_inertia, "kg·m²", kNotNegative,
                        o.model.joints())} {
  Compute(dynamics).From(position, velocity).As(&ModelDynamics::At);
}

void ModelDynamics::At(RobotDynamics& d, const JointPosition& q, const JointVelocity& v) const {
  ComputeDynamics(model_, q, v, d);
  d.M.diagonal() += B_;
  d.p += B_.cwiseProduct(v);
}

}  // namespace pliant
