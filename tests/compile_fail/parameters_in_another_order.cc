// a rule's parameters are the values named in From, in that order
#include "pliant/systems/block.h"

class Spring final : public pliant::Block {
 public:
  Spring() { Compute(torque).From(position, velocity).As(&Spring::Law); }
  pliant::Input<pliant::JointPosition> position{this, "position"};
  pliant::Input<pliant::JointVelocity> velocity{this, "velocity"};
  pliant::Output<pliant::JointTorque> torque{this, "torque"};

 private:
  pliant::JointTorque Law(const pliant::JointVelocity&, const pliant::JointPosition&) const;
};
