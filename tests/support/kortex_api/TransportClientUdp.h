#pragma once

#include <ITransportClient.h>

namespace Kinova::Api {

class TransportClientUdp : public ITransportClient {
 public:
  TransportClientUdp();
  ~TransportClientUdp() override;
  bool connect(std::string host = "127.0.0.1", std::uint32_t port = 10001) override;
  void disconnect() override;
};

}  // namespace Kinova::Api
