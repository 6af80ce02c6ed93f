// a rule returns a value: give the Eigen expression a type
#include "pliant/systems/block.h"

class Twice final : public pliant::Block {
 public:
  Twice() {
    Compute(y).From(u).As([](const pliant::JointTorque& x) { return 2 * x; });
  }
  pliant::Input<pliant::JointTorque> u{this, "u"};
  pliant::Output<pliant::JointTorque> y{this, "y"};
};
