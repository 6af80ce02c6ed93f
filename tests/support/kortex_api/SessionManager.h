#pragma once

#include <IRouterClient.h>
#include <Session.pb.h>

namespace Kinova::Api {

class SessionManager {
 public:
  explicit SessionManager(IRouterClient* router);
  ~SessionManager();
  void CreateSession(const Session::CreateSessionInfo& createSessionInfo);
  void CloseSession();
};

}  // namespace Kinova::Api
