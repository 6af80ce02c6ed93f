#pragma once

#include <functional>

#include <IRouterClient.h>
#include <ITransportClient.h>
#include <KError.h>

namespace Kinova::Api {

class RouterClient : public IRouterClient {
 public:
  RouterClient(ITransportClient* transport, std::function<void(KError)> errorCallback);
  ~RouterClient() override;
  virtual void SetActivationStatus(bool isActive);
};

}  // namespace Kinova::Api
