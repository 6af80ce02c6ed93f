// a rule is a const function: values in, value out
#include "pliant/systems/block.h"

class Twice final : public pliant::Block {
 public:
  Twice() { Compute(y).From(u).As(&Twice::Next); }
  double Next(double x) { return last = 2 * x; }
  double last = 0;
  pliant::Input<double> u{this, "u"};
  pliant::Output<double> y{this, "y"};
};
