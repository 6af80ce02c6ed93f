#include "pliant/plants/gen3_sdk.h"

#include <ActuatorConfigClientRpc.h>
#include <BaseClientRpc.h>
#include <BaseCyclicClientRpc.h>
#include <KDetailedException.h>
#include <RouterClient.h>
#include <SessionManager.h>
#include <TransportClientTcp.h>
#include <TransportClientUdp.h>

#include <array>
#include <atomic>
#include <chrono>
#include <semaphore>
#include <string>

#include "pliant/plants/gen3_faults.h"
#include "pliant/plants/kortex_request.h"
#include "pliant/plants/socket.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

namespace api = Kinova::Api;

/// Runs a call of the SDK; what it throws becomes Error with the arm's words.
template <class Act>
auto Asked(const Gen3Address& address, const std::string& what, const Act& act) {
  try {
    return act();
  } catch (api::KDetailedException& e) {
    const api::Error error = e.getErrorInfo().getError();
    throw kortex::Refusal(address, what, static_cast<int>(error.error_code()),
                          static_cast<int>(error.error_sub_code()), error.error_sub_string());
  } catch (const std::exception& e) {
    throw Error(address.text() + ": " + what + " failed in Kinova's SDK: " + e.what());
  }
}

/// False if it is not that of seven actuators.
bool Take(const api::BaseCyclic::Feedback& from, Gen3Feedback& to) {
  if (from.actuators_size() != kGen3Joints) return false;
  to.frame_id = from.frame_id();
  to.arm_state = static_cast<std::uint32_t>(from.base().active_state());
  to.fault_a = from.base().fault_bank_a();
  to.fault_b = from.base().fault_bank_b();
  to.warning_a = from.base().warning_bank_a();
  to.warning_b = from.base().warning_bank_b();
  for (int i = 0; i < kGen3Joints; ++i) {
    const api::BaseCyclic::ActuatorFeedback& a = from.actuators(i);
    to.actuator[static_cast<std::size_t>(i)] = {.command_id = a.command_id(),
                                                .status_flags = a.status_flags(),
                                                .jitter_us = a.jitter_comm(),
                                                .position = a.position(),
                                                .velocity = a.velocity(),
                                                .torque = a.torque(),
                                                .current = a.current_motor(),
                                                .voltage = a.voltage(),
                                                .motor_temperature = a.temperature_motor(),
                                                .core_temperature = a.temperature_core(),
                                                .fault_a = a.fault_bank_a(),
                                                .fault_b = a.fault_bank_b(),
                                                .warning_a = a.warning_bank_a(),
                                                .warning_b = a.warning_bank_b()};
  }
  return true;
}

/// From the SDK's one receiving thread to the one of the exchange. Lives until the last answer that
/// may still come.
class Arrivals {
 public:
  /// On the SDK's thread.
  void Put(int id, const api::Error& error, const api::BaseCyclic::Feedback& feedback) {
    if (error.error_code() != api::ERROR_NONE) {
      ++refused;
      return;
    }
    const std::size_t next = (end_ + 1) % ring_.size();
    Gen3Feedback& slot = ring_[end_];
    slot.answers = static_cast<std::uint16_t>(id);
    if (next == begin_ || !Take(feedback, slot)) {
      ++unreadable;
      return;
    }
    end_ = next;
    ++received;
    there_.release();
  }

  bool Get(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept {
    const bool is_there =
        patience.count() > 0 ? there_.try_acquire_for(patience) : there_.try_acquire();
    if (!is_there) return false;
    feedback = ring_[begin_];
    begin_ = (begin_ + 1) % ring_.size();
    return true;
  }

  std::atomic<std::int64_t> received = 0, refused = 0, unreadable = 0;

 private:
  std::array<Gen3Feedback, 64> ring_;
  std::atomic<std::size_t> begin_ = 0, end_ = 0;
  std::counting_semaphore<64> there_{0};
};

/// A transport, its router and a session, which end in the other order.
template <class Transport>
class Way {
 public:
  Way(const Gen3Address& address, int port) : router_{&transport_, [](api::KError) {}} {
    if (!transport_.connect(address.host, static_cast<std::uint32_t>(port)))
      throw kortex::Unreachable(address, "the SDK could not connect to port " + Text(port));
    api::Session::CreateSessionInfo info;
    info.set_username(address.user);
    info.set_password(address.password);
    info.set_session_inactivity_timeout(
        static_cast<std::uint32_t>(address.session_timeout.count()));
    info.set_connection_inactivity_timeout(
        static_cast<std::uint32_t>(address.connection_timeout.count()));
    try {
      Asked(address, "CreateSession for user '" + address.user + "'",
            [&] { session_.CreateSession(info); });
    } catch (const Error&) {
      Leave();
      throw;
    }
  }
  ~Way() {
    try {
      session_.CloseSession();
    } catch (const std::exception&) {
      // The arm ends a silent session by itself.
    }
    Leave();
  }
  Way(const Way&) = delete;
  Way& operator=(const Way&) = delete;

  api::RouterClient& router() { return router_; }

 private:
  void Leave() {
    router_.SetActivationStatus(false);
    transport_.disconnect();
  }

  Transport transport_;
  api::RouterClient router_;
  api::SessionManager session_{&router_};
};

class Gen3Sdk final : public Gen3Link {
 public:
  explicit Gen3Sdk(const Gen3Address& address)
      : address_{address},
        tcp_{address, address.tcp_port},
        udp_{address, address.udp_port},
        base_{&tcp_.router()},
        actuators_{&tcp_.router()},
        cyclic_{&udp_.router()} {
    for (int i = 0; i < kGen3Joints; ++i) command_.add_actuators();
  }

  void ClearFaults() override {
    Asked(address_, "ClearFaults", [&] { base_.ClearFaults(0, Patience()); });
  }

  std::uint32_t ArmState() override {
    return Asked(address_, "GetArmState", [&] {
      return static_cast<std::uint32_t>(base_.GetArmState(0, Patience()).active_state());
    });
  }

  int ActuatorCount() override {
    return Asked(address_, "GetActuatorCount",
                 [&] { return static_cast<int>(base_.GetActuatorCount(0, Patience()).count()); });
  }

  Gen3Servoing Servoing() override {
    return Asked(address_, "GetServoingMode", [&] {
      return static_cast<Gen3Servoing>(base_.GetServoingMode(0, Patience()).servoing_mode());
    });
  }

  void SetServoing(Gen3Servoing servoing) override {
    api::Base::ServoingModeInformation mode;
    mode.set_servoing_mode(static_cast<api::Base::ServoingMode>(servoing));
    Asked(address_, "SetServoingMode " + Gen3ServoingName(servoing),
          [&] { base_.SetServoingMode(mode, 0, Patience()); });
  }

  Gen3Mode Mode(int joint) override {
    const std::uint32_t device = Device(joint);
    return Asked(address_, "GetControlMode of actuator " + Text(device), [&] {
      return static_cast<Gen3Mode>(actuators_.GetControlMode(device, Patience()).control_mode());
    });
  }

  void SetMode(int joint, Gen3Mode mode) override {
    const std::uint32_t device = Device(joint);
    api::ActuatorConfig::ControlModeInformation information;
    information.set_control_mode(static_cast<api::ActuatorConfig::ControlMode>(mode));
    Asked(address_, "SetControlMode " + Gen3ModeName(mode) + " of actuator " + Text(device),
          [&] { actuators_.SetControlMode(information, device, Patience()); });
  }

  Gen3Feedback Read() override {
    Gen3Feedback feedback;
    const auto read = Asked(address_, "RefreshFeedback", [&] {
      return cyclic_.RefreshFeedback(
          0, {false, 0, static_cast<std::uint32_t>(address_.connect_limit.count())});
    });
    if (!Take(read, feedback))
      throw Error("the feedback of " + address_.text() + " must be that of 7 actuators, got " +
                  Text(read.actuators_size()) + "; is it a Gen3 of 7 degrees of freedom?");
    return feedback;
  }

  int Send(const Gen3Command& command) noexcept override {
    const std::uint16_t id = next_id_++;
    command_.set_frame_id(id);
    for (int i = 0; i < kGen3Joints; ++i) {
      const Gen3Command::Actuator& from = command.actuator[static_cast<std::size_t>(i)];
      api::BaseCyclic::ActuatorCommand& to = *command_.mutable_actuators(i);
      to.set_command_id(id);
      to.set_position(from.position);
      to.set_velocity(from.velocity);
      to.set_torque_joint(from.torque);
      to.set_current_motor(from.current);
    }
    try {
      cyclic_.Refresh_callback(
          command_,
          [arrivals = arrivals_, id](const api::Error& error,
                                     const api::BaseCyclic::Feedback& feedback) {
            arrivals->Put(id, error, feedback);
          },
          0);
    } catch (const std::exception&) {
      ++unsent_;
      return -1;
    }
    ++sent_;
    return id;
  }

  bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept override {
    return arrivals_->Get(feedback, patience);
  }

  Gen3Traffic traffic() const noexcept override {
    return {.sent = sent_,
            .received = arrivals_->received,
            .unsent = unsent_,
            .refused = arrivals_->refused,
            .unreadable = arrivals_->unreadable};
  }

 private:
  api::RouterClientSendOptions Patience() const {
    return {false, 0, static_cast<std::uint32_t>(address_.answer_limit.count())};
  }
  static std::uint32_t Device(int joint) {
    Require(joint >= 0 && joint < kGen3Joints, "a joint of a Gen3 must be 0 ... 6", joint);
    return static_cast<std::uint32_t>(joint + 1);
  }

  const Gen3Address address_;
  Way<api::TransportClientTcp> tcp_;
  Way<api::TransportClientUdp> udp_;
  api::Base::BaseClient base_;
  api::ActuatorConfig::ActuatorConfigClient actuators_;
  api::BaseCyclic::BaseCyclicClient cyclic_;
  api::BaseCyclic::Command command_;
  std::uint16_t next_id_ = 0;
  std::atomic<std::int64_t> sent_ = 0, unsent_ = 0;
  const std::shared_ptr<Arrivals> arrivals_ = std::make_shared<Arrivals>();
};

}  // namespace

std::unique_ptr<Gen3Link> ConnectGen3BySdk(const Gen3Address& address) {
  try {
    // The SDK's own takes minutes where there is no arm.
    ConnectTcp(address.host, address.tcp_port, address.connect_limit);
  } catch (const Error& e) {
    throw kortex::Unreachable(address, e.what());
  }
  return std::make_unique<Gen3Sdk>(address);
}

}  // namespace pliant
