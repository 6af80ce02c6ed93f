#pragma once

#include <cstdint>
#include <string>

namespace Kinova::Api {

class ITransportClient {
 public:
  virtual ~ITransportClient() = default;
  virtual bool connect(std::string host, std::uint32_t port) = 0;
  virtual void disconnect() = 0;
};

}  // namespace Kinova::Api
