#pragma once

#include <Errors.pb.h>

namespace Kinova::Api {

class KError {
 public:
  Error getError() const;
};

}  // namespace Kinova::Api
