#pragma once

#include <functional>

#include <BaseCyclic.pb.h>
#include <Errors.pb.h>
#include <IRouterClient.h>

namespace Kinova::Api::BaseCyclic {

class BaseCyclicClient {
 public:
  explicit BaseCyclicClient(IRouterClient* router);
  void Refresh_callback(const Command& command,
                        std::function<void(const Error&, const Feedback&)> callback,
                        std::uint32_t deviceId = 0);
  Feedback RefreshFeedback(std::uint32_t deviceId = 0,
                           const RouterClientSendOptions& options = {false, 0, 3000});
};

}  // namespace Kinova::Api::BaseCyclic
