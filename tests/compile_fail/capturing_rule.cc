// a rule reads its arguments and the block's constants: capture nothing
#include "pliant/systems/block.h"

class Twice final : public pliant::Block {
 public:
  Twice() {
    Compute(y).From(u).As([this](double x) { return factor * x; });
  }
  double factor = 2;
  pliant::Input<double> u{this, "u"};
  pliant::Output<double> y{this, "y"};
};
