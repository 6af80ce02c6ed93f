// a rule of several values returns a std::tuple of them
#include "pliant/systems/block.h"

class Pair final : public pliant::Block {
 public:
  Pair() {
    Every(std::chrono::milliseconds(1)).Update(a, b).From(a).As([](double x) { return x; });
  }
  pliant::Discrete<double> a{this, "a"}, b{this, "b"};
};
