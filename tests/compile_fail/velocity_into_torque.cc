// Connect(from, to): the ports carry different physical quantities
#include "pliant/systems/constant.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/gain.h"

void Wire(pliant::DiagramBuilder& b, pliant::Constant<pliant::JointVelocity>& velocity,
          pliant::Gain<pliant::JointTorque>& torque) {
  b.Connect(velocity.y, torque.u);
}
