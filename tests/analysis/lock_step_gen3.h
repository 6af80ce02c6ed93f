#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pliant/analysis/run_on_arm.h"
#include "pliant/diagrams/gen3_emulator.h"
#include "pliant/plants/gen3_wire.h"

namespace pliant {

/// What an emulated arm does in a millisecond.
struct Gen3Moment {
  double t;  ///< since low-level servoing first began [s]; < 0 before
  JointPosition position;
  JointVelocity velocity;
  JointTorque torque;  ///< these two as it received them
  MotorCurrent current;
  Gen3Servoing servoing;
  bool in_position;  ///< the mode of all joints
  bool in_fault;
};

/// An emulator in lock-step on ports of its own, and all that its arm does.
class LockStepGen3 {
 public:
  explicit LockStepGen3(const std::vector<std::string>& faults = {},
                        Gen3Body::Options arm = DefaultArm())
      : emulator_{OptionsOf(faults, std::move(arm))} {}

  static Gen3Body::Options DefaultArm() { return {}; }

  std::string address() const {
    return "127.0.0.1:" + std::to_string(emulator_.port()) + "," +
           std::to_string(emulator_.udp_port());
  }
  /// A way to it by the wire that knows when an answer was lost: the arm has moved on, or has said
  /// no. So whether an answer counts as lost does not depend on how busy this machine is.
  std::function<std::unique_ptr<Gen3Link>(const Gen3Address&)> connect() {
    return [this](const Gen3Address& address) {
      auto link = std::make_unique<SureLink>(ConnectGen3(address), emulator_);
      link_ = link.get();
      return link;
    };
  }

  std::vector<Gen3Moment> moments() const {
    const std::lock_guard lock(mutex_);
    return moments_;
  }
  std::string failure() const { return emulator_.failure(); }
  Gen3Emulator::Counts counts() const { return emulator_.counts(); }

  /// Until the link has noticed that its connection is lost; in `at` alone.
  void AwaitLoss() const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (link_->connected() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
  }

  /// Called in each step at the time since low-level servoing began, while the run waits for it.
  std::function<void(double t)> at = {};

 private:
  class SureLink final : public Gen3Link {
   public:
    SureLink(std::unique_ptr<Gen3Link> wire, const Gen3Emulator& emulator)
        : wire_{std::move(wire)}, emulator_{emulator} {}

    void ClearFaults() override { wire_->ClearFaults(); }
    std::uint32_t ArmState() override { return wire_->ArmState(); }
    int ActuatorCount() override { return wire_->ActuatorCount(); }
    Gen3Servoing Servoing() override { return wire_->Servoing(); }
    void SetServoing(Gen3Servoing s) override { wire_->SetServoing(s); }
    Gen3Mode Mode(int joint) override { return wire_->Mode(joint); }
    void SetMode(int joint, Gen3Mode mode) override { wire_->SetMode(joint, mode); }
    Gen3Feedback Read() override { return wire_->Read(); }
    int Send(const Gen3Command& command) noexcept override {
      before_ = Served();
      return wire_->Send(command);
    }
    bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds patience) noexcept override {
      using Clock = std::chrono::steady_clock;
      for (const auto end = Clock::now() + patience;;) {
        const bool served = Served() != before_;  // read first: the answer is there by then
        if (wire_->Receive(feedback, served ? std::chrono::nanoseconds(0) : kPause)) return true;
        if (served || Served() != before_ || Clock::now() >= end)
          return wire_->Receive(feedback, {});
      }
    }
    Gen3Traffic traffic() const noexcept override { return wire_->traffic(); }
    bool connected() const noexcept override { return wire_->connected(); }

   private:
    static constexpr std::chrono::microseconds kPause{500};

    std::int64_t Served() const {
      return emulator_.counts().ticks + wire_->traffic().refused + wire_->traffic().unreadable;
    }

    const std::unique_ptr<Gen3Link> wire_;
    const Gen3Emulator& emulator_;
    std::int64_t before_ = 0;
  };

  Gen3Emulator::Options OptionsOf(const std::vector<std::string>& faults, Gen3Body::Options arm) {
    arm.watch = [this](const Gen3Body& body) { Watch(body); };
    Gen3Emulator::Options o{.arm = std::move(arm), .lock_step = true};
    for (const std::string& text : faults)
      o.faults.push_back(FaultOrder::Of(text, Gen3Emulator::Kinds()));
    return o;
  }
  void Watch(const Gen3Body& body) {
    const double t = body.servoed().value_or(-1);
    bool in_position = true;
    for (int j = 0; j < kGen3Joints; ++j)
      in_position = in_position && body.mode(j) == Gen3Mode::Position;
    {
      const std::lock_guard lock(mutex_);
      moments_.push_back({t, body.position(), body.velocity(), body.commanded_torque(),
                          body.commanded_current(), body.servoing(), in_position, body.in_fault()});
    }
    if (at && t >= 0) at(t);
  }

  const Gen3Link* link_ = nullptr;
  mutable std::mutex mutex_;
  std::vector<Gen3Moment> moments_;
  Gen3Emulator emulator_;  // the last: its thread uses the others
};

/// What a run of these tests commands.
inline std::string ModeText(ControlMode mode) {
  return mode == ControlMode::Torque ? "schedule: [{at_s: 0, mode: torque}]\n"
         : mode == ControlMode::TorqueHighVelocity
             ? "schedule: [{at_s: 0, mode: torque_high_velocity}]\n"
             : "";
}

/// The tool of a Gen3 goes round a circle of 5 cm at 0.1 m/s, by positions or torques or currents.
inline std::string CirclingArm(ControlMode mode, const std::string& station,
                               const std::string& more = "") {
  return "title: A circling arm\nsummary: Of a test.\nrobot: gen3\nstation: " + station +
         "\ncontroller: !Compliance\n  tool: tool_frame\n" +
         (mode == ControlMode::Position ? "  command: position\n" : "") +
         "  reference: !Circle {center: [0, 0.05, 0], normal: [1, 0, 0], speed: 2, rise_s: 0.5}\n" +
         ModeText(mode) + more;
}

inline std::string OnArm(const std::string& address, const std::string& more = "") {
  return "!Gen3 {address: '" + address + "', lock_step: true" + more + "}";
}

}  // namespace pliant
