#pragma once

#include <Base.pb.h>
#include <IRouterClient.h>

namespace Kinova::Api::Base {

class BaseClient {
 public:
  explicit BaseClient(IRouterClient* router);
  void ClearFaults(std::uint32_t deviceId = 0,
                   const RouterClientSendOptions& options = {false, 0, 3000});
  ArmStateInformation GetArmState(std::uint32_t deviceId = 0,
                                  const RouterClientSendOptions& options = {false, 0, 3000});
  ActuatorInformation GetActuatorCount(std::uint32_t deviceId = 0,
                                       const RouterClientSendOptions& options = {false, 0, 3000});
  ServoingModeInformation GetServoingMode(std::uint32_t deviceId = 0,
                                          const RouterClientSendOptions& options = {false, 0,
                                                                                    3000});
  void SetServoingMode(const ServoingModeInformation& mode, std::uint32_t deviceId = 0,
                       const RouterClientSendOptions& options = {false, 0, 3000});
};

}  // namespace Kinova::Api::Base
