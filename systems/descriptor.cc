#include "pliant/systems/descriptor.h"

#include <unistd.h>

namespace pliant::internal {

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

}  // namespace pliant::internal
