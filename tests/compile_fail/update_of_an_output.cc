// an event updates Discrete and Continuous values
#include "pliant/systems/block.h"

class Twice final : public pliant::Block {
 public:
  Twice() {
    Every(std::chrono::milliseconds(1)).Update(y).From().As([] { return 1.0; });
  }
  pliant::Output<double> y{this, "y"};
};
