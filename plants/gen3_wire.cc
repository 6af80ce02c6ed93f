#include "pliant/plants/gen3_wire.h"

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>

#include "pliant/plants/kortex_exchange.h"
#include "pliant/plants/kortex_services.h"

namespace pliant {

namespace {

using namespace std::chrono_literals;

class Gen3Wire final : public Gen3Link {
 public:
  explicit Gen3Wire(const Gen3Address& address)
      : services_{address}, exchange_{address}, keeper_{[this](std::stop_token stop) {
          Keep(stop);
        }} {}

  void ClearFaults() override { services_.ClearFaults(); }
  std::uint32_t ArmState() override { return services_.ArmState(); }
  int ActuatorCount() override { return services_.ActuatorCount(); }
  Gen3Servoing Servoing() override { return services_.Servoing(); }
  void SetServoing(Gen3Servoing servoing) override { services_.SetServoing(servoing); }
  Gen3Mode Mode(int joint) override { return services_.Mode(joint); }
  void SetMode(int joint, Gen3Mode mode) override { services_.SetMode(joint, mode); }
  Gen3Feedback Read() override { return exchange_.Read(); }
  int Send(const Gen3Command& command) noexcept override { return exchange_.Send(command); }
  bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept override {
    return exchange_.Receive(feedback, patience);
  }
  Gen3Traffic traffic() const noexcept override { return exchange_.traffic(); }
  bool connected() const noexcept override { return services_.connected(); }

 private:
  void Keep(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    std::unique_lock lock(mutex);
    while (!stopped.wait_for(lock, stop, 50ms, [&] { return stop.stop_requested(); })) {
      services_.KeepAlive(150ms);
      exchange_.KeepAlive(500ms);
    }
  }

  kortex::Services services_;
  kortex::Exchange exchange_;
  std::jthread keeper_;  // the last: it uses the others
};

}  // namespace

std::unique_ptr<Gen3Link> ConnectGen3(const Gen3Address& address) {
  return std::make_unique<Gen3Wire>(address);
}

}  // namespace pliant
