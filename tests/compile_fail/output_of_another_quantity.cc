// a rule returns the quantity it rules
#include "pliant/systems/block.h"

class Arm final : public pliant::Block {
 public:
  Arm() {
    Compute(torque).From(v).As([](const pliant::JointVelocity& now) { return now; });
  }
  pliant::Input<pliant::JointVelocity> v{this, "v"};
  pliant::Output<pliant::JointTorque> torque{this, "torque"};
};
