// a rule returns the quantity it rules
#include "pliant/systems/block.h"

class Arm final : public pliant::Block {
 public:
  Arm() {
    Derivative(q).From(q).As([](const pliant::JointPosition& now) { return now; });
  }
  pliant::Continuous<pliant::JointPosition> q{this, "q"};
};
