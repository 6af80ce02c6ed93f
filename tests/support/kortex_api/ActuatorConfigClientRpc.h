#pragma once

#include <ActuatorConfig.pb.h>
#include <IRouterClient.h>

namespace Kinova::Api::ActuatorConfig {

class ActuatorConfigClient {
 public:
  explicit ActuatorConfigClient(IRouterClient* router);
  ControlModeInformation GetControlMode(std::uint32_t deviceId = 0,
                                        const RouterClientSendOptions& options = {false, 0, 3000});
  void SetControlMode(const ControlModeInformation& mode, std::uint32_t deviceId = 0,
                      const RouterClientSendOptions& options = {false, 0, 3000});
};

}  // namespace Kinova::Api::ActuatorConfig
