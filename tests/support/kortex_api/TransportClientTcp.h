#pragma once

#include <ITransportClient.h>

namespace Kinova::Api {

class TransportClientTcp : public ITransportClient {
 public:
  TransportClientTcp();
  ~TransportClientTcp() override;
  bool connect(std::string host = "127.0.0.1", std::uint32_t port = 10000) override;
  void disconnect() override;
};

}  // namespace Kinova::Api
