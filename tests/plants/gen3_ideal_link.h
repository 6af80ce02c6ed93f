#pragma once

#include <cmath>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "pliant/plants/gen3_link.h"
#include "pliant/systems/error.h"

namespace pliant {

/// A way to actuators that are where they are put: what was sent and asked is written down, and the
/// answer to a command is ready at once.
class Gen3IdealLink final : public Gen3Link {
 public:
  explicit Gen3IdealLink(int first_id = 0) : next_id_{first_id} {}

  void ClearFaults() override { Note("clear faults"); }
  std::uint32_t ArmState() override { return arm_state; }
  int ActuatorCount() override { return actuators; }
  Gen3Servoing Servoing() override { return servoing; }
  void SetServoing(Gen3Servoing s) override {
    Note(s == Gen3Servoing::LowLevel ? "low level" : "single level");
    servoing = s;
  }
  Gen3Mode Mode(int joint) override { return mode[static_cast<std::size_t>(joint)]; }
  void SetMode(int joint, Gen3Mode m) override {
    Note("mode " + std::to_string(static_cast<int>(m)) + " of " + std::to_string(joint));
    mode[static_cast<std::size_t>(joint)] = m;
  }
  Gen3Feedback Read() override { return now; }
  int Send(const Gen3Command& command) noexcept override {
    sent = command;
    ++traffic_.sent;
    const int id = next_id_;
    next_id_ = (next_id_ + 1) % 65536;
    Gen3Feedback answer = now;
    answer.answers = static_cast<std::uint16_t>(id);
    if (deliver)
      deliver(answer, *this);
    else
      answers.push_back(answer);
    return id;
  }
  bool Receive(Gen3Feedback& feedback, std::chrono::nanoseconds) noexcept override {
    if (answers.empty()) return false;
    feedback = answers.front();
    answers.pop_front();
    return true;
  }
  Gen3Traffic traffic() const noexcept override { return traffic_; }

  std::vector<std::string> asked() {
    const std::lock_guard lock(mutex_);
    return asked_;
  }

  std::uint32_t arm_state = 7;  // ready
  int actuators = kGen3Joints;
  Gen3Servoing servoing = Gen3Servoing::SingleLevel;
  std::array<Gen3Mode, kGen3Joints> mode = [] {
    std::array<Gen3Mode, kGen3Joints> all;
    all.fill(Gen3Mode::Position);
    return all;
  }();
  Gen3Feedback now;     ///< what the sensors say
  Gen3Command sent;     ///< last
  std::string refuses;  ///< a service whose name begins so
  std::deque<Gen3Feedback> answers;
  /// What becomes of an answer; none: it arrives at once.
  std::function<void(const Gen3Feedback&, Gen3IdealLink&)> deliver;

 private:
  void Note(const std::string& service) {
    const std::lock_guard lock(mutex_);
    asked_.push_back(service);
    if (!refuses.empty() && service.starts_with(refuses))
      throw Error("the arm refused: " + service);
  }

  std::mutex mutex_;
  std::vector<std::string> asked_;
  Gen3Traffic traffic_;
  int next_id_;
};

}  // namespace pliant
