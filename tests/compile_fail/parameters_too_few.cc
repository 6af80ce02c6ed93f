// a rule's parameters are the values named in From, in that order
#include "pliant/systems/block.h"

class Twice final : public pliant::Block {
 public:
  Twice() {
    Compute(y).From(u, clock).As([](double x) { return 2 * x; });
  }
  pliant::Input<double> u{this, "u"};
  pliant::Output<double> y{this, "y"};
};
