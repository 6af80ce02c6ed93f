// a signal is a copyable type
#include <memory>

#include "pliant/systems/block.h"

class Owner final : public pliant::Block {
 public:
  pliant::Input<std::unique_ptr<int>> u{this, "u"};
};
