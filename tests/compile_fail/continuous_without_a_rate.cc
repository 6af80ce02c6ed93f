// a Continuous value needs a rate: give its signal a type Rate
#include "pliant/systems/block.h"

class Motor final : public pliant::Block {
 public:
  pliant::Continuous<pliant::MotorCurrent> i{this, "i"};
};
