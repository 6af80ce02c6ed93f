#pragma once

// Declarations of what is used of Kinova's SDK, KortexApi 2.x: names and types as its public
// examples and reference use them (github.com/Kinovarobotics/Kinova-kortex2_Gen3_G3L). For
// compiling only.

#include <cstdint>

namespace Kinova::Api {

struct RouterClientSendOptions {
  bool andForget;
  std::uint32_t delay_ms;
  std::uint32_t timeout_ms;
};

class IRouterClient {
 public:
  virtual ~IRouterClient() = default;
};

}  // namespace Kinova::Api
