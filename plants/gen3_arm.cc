#include "pliant/plants/gen3_arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

constexpr double kDegree = std::numbers::pi / 180;  // [rad]
constexpr std::uint32_t kInFault = 4;               // ArmState
constexpr std::uint32_t kMajorFault = 0x1000;       // StatusFlags
constexpr std::uint32_t kLowLevel = 6;              // ArmState
constexpr int kMostAnswers = 16;                    // taken in a tick
constexpr int kLeft = 50;                           // ticks without low-level servoing
constexpr double kDampingOfLimit = 0.08;            // D per torque limit [s/rad]
constexpr int kMostRefusals = 3;                    // in a row
constexpr auto kServicePause = std::chrono::milliseconds(2);

Gen3Mode ModeOf(ControlMode mode) {
  switch (mode) {
    case ControlMode::Torque:
      return Gen3Mode::Torque;
    case ControlMode::Current:
      return Gen3Mode::Current;
    case ControlMode::TorqueHighVelocity:
      return Gen3Mode::TorqueHighVelocity;
    case ControlMode::Position:
      break;
  }
  return Gen3Mode::Position;
}

/// The part of x [°] in [−180°, 180°).
double HalfTurn(double x) { return x - 360 * std::floor(x / 360 + 0.5); }

/// On the wire [°]. Rounded to single precision it may be a whole turn, which is none.
float OnWire(double q) {
  const double turns = q / (2 * std::numbers::pi);
  const auto degrees = static_cast<float>(360 * (turns - std::floor(turns)));
  return degrees < 360 ? degrees : 0;
}

bool IsFinite(const Gen3Feedback::Actuator& a) {
  return std::isfinite(a.position) && std::isfinite(a.velocity) && std::isfinite(a.torque) &&
         std::isfinite(a.current);
}

bool SameMotion(const Gen3Feedback::Actuator& a, const Gen3Feedback::Actuator& b) {
  return a.position == b.position && a.velocity == b.velocity && a.current == b.current;
}

/// x within ± limit; what is no number stays as it was.
float Within(double x, double limit, float before) {
  return std::isfinite(x) ? static_cast<float>(std::clamp(x, -limit, limit)) : before;
}

}  // namespace

Gen3Arm::Gen3Arm(Options o)
    : o_{std::move(o)},
      torque_limit_{o_.model.effort_limit()},
      step_limit_{o_.model.velocity_limit() * seconds(o_.period)},
      work_{o_.model} {
  Require(o_.link != nullptr, "link is missing: expected a way to the arm, as of ConnectGen3");
  Require(o_.model.size() == kGen3Joints, "model must have the 7 joints of a Gen3",
          o_.model.size());
  RequireEachInRange("current_limit", o_.current_limit, "A", kPositive, o_.model.joints());
  RequireEachInRange("torque_per_ampere", o_.torque_per_ampere, "N·m/A", kPositive,
                     o_.model.joints());
  Require(o_.frozen_after >= 0, "frozen_after must be >= 0", o_.frozen_after);
  for (int j = 0; j < kGen3Joints; ++j)
    if (o_.model.joint(j).type == Joint::Type::Continuous) continuous_ |= JointBits{1} << j;

  if (o_.clear_faults) o_.link->ClearFaults();
  const int count = o_.link->ActuatorCount();
  if (count != kGen3Joints)
    throw Error("the arm must have 7 actuators, as the model has, got " + Text(count));
  if (o_.link->ArmState() == kInFault)
    throw Error(
        "the arm is in fault and takes no commands\n"
        "see that it is safe to move it, then clear its faults: pliant recover gen3 "
        "--clear-faults");
  feedback_ = o_.link->Read();
  for (std::size_t j = 0; j < feedback_.actuator.size(); ++j)
    if (!IsFinite(feedback_.actuator[j]))
      throw Error("what the arm measures must be finite, got NaN or infinity at joint " +
                  Text(j + 1) + "\nswitch the arm off and on");
  const Joints& joints = o_.model.joints();
  sample_ = {.position = JointPosition::Zero(joints),
             .velocity = JointVelocity::Zero(joints),
             .torque = JointTorque::Zero(joints),
             .current = MotorCurrent::Zero(joints),
             .temperature = JointTemperature::Zero(joints),
             .status = {.mode = ControlMode::Position, .switching = (1U << kGen3Joints) - 1},
             .report = {}};
  Decode();
  reference_ = sample_.position;
  // With the scheduler and the processor that are the process's now, not the ticks'.
  if (o_.lock_step.count() == 0)
    services_ = std::jthread([this](const std::stop_token& stop) { Serve(stop); });
}

Gen3Arm::~Gen3Arm() {
  try {
    HandBack();
  } catch (const std::exception&) {
    // Nobody is left to be told; the arm leaves low-level servoing when its session runs out.
  }
}

/// Whether a joint is, for all that is known, moved by torques or currents.
bool Gen3Arm::Moves(int joint) const noexcept {
  const auto i = static_cast<std::size_t>(joint);
  constexpr auto kPosition = static_cast<std::uint8_t>(Gen3Mode::Position);
  const auto mode = mode_[i].load(std::memory_order_relaxed);
  return mode != kNone && mode != kPosition &&
         asked_[i].load(std::memory_order_relaxed) != kPosition && !failed_ && !over_ &&
         !(sample_.status.faulted >> joint & 1);
}

/// What has just arrived, if it is newer than what was there.
void Gen3Arm::Take(const Gen3Feedback& arrived) noexcept {
  Gen3Report& report = sample_.report;
  ++report.answered;
  const Sent& answered = sent_[arrived.answers % sent_.size()];
  if (answered.id != arrived.answers || answered.tick <= newest_) {
    ++report.out_of_order;
    return;
  }
  if (answered.tick != sent_last_) ++report.late;
  newest_ = answered.tick;
  if (!std::ranges::all_of(arrived.actuator, IsFinite)) {
    ++report.not_finite;
    return;
  }
  age_ = static_cast<int>(tick_ - answered.tick - 1);
  SeeWhatStandsStill(arrived);
  feedback_ = arrived;
  Decode();
}

void Gen3Arm::SeeWhatStandsStill(const Gen3Feedback& arrived) noexcept {
  for (std::size_t j = 0; j < same_.size(); ++j) {
    const bool torque = arrived.actuator[j].torque == feedback_.actuator[j].torque;
    same_torque_[j] = torque ? same_torque_[j] + 1 : 0;
    same_[j] = torque && SameMotion(arrived.actuator[j], feedback_.actuator[j]) ? same_[j] + 1 : 0;
  }
}

void Gen3Arm::Decode() noexcept {
  ArmStatus& status = sample_.status;
  Gen3Report& report = sample_.report;
  status.faulted = 0;
  for (int j = 0; j < kGen3Joints; ++j) {
    const auto i = static_cast<std::size_t>(j);
    const Gen3Feedback::Actuator& a = feedback_.actuator[i];
    double& q = sample_.position(j);
    q = continuous_ >> j & 1 ? q + kDegree * HalfTurn(a.position - q / kDegree)
                             : kDegree * HalfTurn(a.position);
    sample_.velocity(j) = kDegree * a.velocity;
    sample_.torque(j) = -static_cast<double>(a.torque);
    sample_.current(j) = a.current;
    sample_.temperature(j) = a.motor_temperature;
    const int n = o_.frozen_after;
    const bool dead_torque = n > 0 && same_torque_[i] > n && same_[i] <= n;
    if (a.fault_a || a.fault_b || a.status_flags & kMajorFault || dead_torque)
      status.faulted |= JointBits{1} << j;
    report.fault[i] = a.fault_a;
    report.warning[i] = a.warning_a;
    report.flags[i] = a.status_flags;
  }
  status.arm_faulted = feedback_.fault_a || feedback_.fault_b || feedback_.arm_state == kInFault;
  report.base_fault = feedback_.fault_a;
  report.base_warning = feedback_.warning_a;
  report.arm_state = feedback_.arm_state;
}

const Gen3Sample& Gen3Arm::Latest() noexcept {
  if (!begun_) return sample_;
  ++tick_;
  ++age_;
  for (int k = 0; k < kMostAnswers; ++k) {
    // One that did not come is lost, and the next may be so too.
    const auto patience = prompt_ ? o_.lock_step : o_.lock_step / 100;
    const bool waits = newest_ != sent_last_;
    if (!o_.link->Receive(arrived_, waits ? patience : std::chrono::nanoseconds{0})) break;
    Take(arrived_);
  }
  prompt_ = newest_ == sent_last_;
  const Gen3Traffic traffic = o_.link->traffic();
  Gen3Report& report = sample_.report;
  report.sent = traffic.sent;
  refusals_ = age_ > 0 && traffic.refused > report.refused ? refusals_ + 1 : 0;
  report.refused = traffic.refused;
  report.unreadable = traffic.unreadable;
  report.unsent = traffic.unsent;
  ArmStatus& status = sample_.status;
  const int same = std::ranges::max(same_);
  status.age = o_.frozen_after > 0 && same > o_.frozen_after ? std::max(age_, same) : age_;
  if (feedback_.arm_state == kLowLevel)
    not_low_level_ = 0;
  else if (not_low_level_ >= 0)
    ++not_low_level_;
  status.connected =
      !failed_ && refusals_ < kMostRefusals && not_low_level_ < kLeft && o_.link->connected();
  const std::uint8_t wanted = wanted_;
  status.switching = 0;
  for (int j = 0; j < kGen3Joints; ++j)
    if (!low_level_ || mode_[static_cast<std::size_t>(j)] != wanted)
      status.switching |= JointBits{1} << j;
  return sample_;
}

/// Position commands: held, led or measured, as the joint's mode wants it.
void Gen3Arm::Steer(ControlMode mode, const JointPosition& q_d) noexcept {
  for (int j = 0; j < kGen3Joints; ++j) {
    const double before = reference_(j);
    double& r = reference_(j);
    if (failed_ || sample_.status.faulted >> j & 1) {
      // Where it was: a joint that leaves it is held by its firmware.
    } else if (Moves(j) || !low_level_)
      r = sample_.position(j);
    else if (mode == ControlMode::Position && std::isfinite(q_d(j)))
      r += std::clamp(q_d(j) - r, -step_limit_(j), step_limit_(j));
    Gen3Command::Actuator& a = command_.actuator[static_cast<std::size_t>(j)];
    a.position = OnWire(r);
    a.velocity = Moves(j) || !low_level_
                     ? 0
                     : static_cast<float>((r - before) / seconds(o_.period) / kDegree);
  }
}

void Gen3Arm::Command(ControlMode mode, const JointPosition& q_d, const JointTorque& tau_d,
                      const MotorCurrent& i_d) noexcept {
  if (over_) return;
  if (!IsMode(mode)) mode = ControlMode::Position;
  wanted_ = static_cast<std::uint8_t>(ModeOf(mode));
  sample_.status.mode = mode;
  Steer(mode, q_d);
  const bool torques = mode == ControlMode::Torque || mode == ControlMode::TorqueHighVelocity;
  sample_.status.saturated = 0;
  for (int j = 0; j < kGen3Joints; ++j) {
    Gen3Command::Actuator& a = command_.actuator[static_cast<std::size_t>(j)];
    const bool cut = (torques && !(std::abs(tau_d(j)) <= torque_limit_(j))) ||
                     (mode == ControlMode::Current && !(std::abs(i_d(j)) <= o_.current_limit(j)));
    if (cut) sample_.status.saturated |= JointBits{1} << j;
    // Whatever the arm is asked for, a joint may still be in another mode.
    a.torque = Within(tau_d(j), torque_limit_(j), a.torque);
    a.current = Within(i_d(j), o_.current_limit(j), a.current);
  }
  begun_ = true;
  if (o_.lock_step.count() > 0)
    while (!failed_ && ServeOne()) {
    }
  Send();
}

void Gen3Arm::Send() noexcept {
  const int id = o_.link->Send(command_);
  if (id < 0) return;
  sent_[static_cast<std::size_t>(id) % sent_.size()] = {.id = id, .tick = tick_};
  sent_last_ = tick_;
}

bool Gen3Arm::Try(const std::string& what, const std::function<void()>& service) {
  try {
    service();
    return true;
  } catch (const std::exception& e) {
    const std::lock_guard lock(failures_mutex_);
    failures_ += (failures_.empty() ? "" : "\n") + what + ": " + e.what();
    failed_ = true;
    return false;
  }
}

/// The next service that is wanted; whether there was one.
bool Gen3Arm::ServeOne() {
  const std::uint8_t wanted = wanted_;
  if (wanted == kNone) return false;
  if (!low_level_) {
    if (Try("low-level servoing", [&] { o_.link->SetServoing(Gen3Servoing::LowLevel); }))
      low_level_ = true;
    return true;
  }
  for (int j = 0; j < kGen3Joints; ++j) {
    std::atomic<std::uint8_t>& mode = mode_[static_cast<std::size_t>(j)];
    if (mode == wanted) continue;
    asked_[static_cast<std::size_t>(j)] = wanted;
    if (Try("the mode of joint " + Text(j + 1),
            [&] { o_.link->SetMode(j, static_cast<Gen3Mode>(wanted)); }))
      mode = wanted;
    return true;
  }
  return false;
}

void Gen3Arm::Serve(const std::stop_token& stop) {
  while (!stop.stop_requested() && !failed_)
    if (!ServeOne()) std::this_thread::sleep_for(kServicePause);
}

void Gen3Arm::GiveBack() {
  bool leads = true;
  Try("who moves the arm", [&] { leads = o_.link->Servoing() == Gen3Servoing::LowLevel; });
  constexpr auto kPosition = static_cast<std::uint8_t>(Gen3Mode::Position);
  for (int j = 0; j < kGen3Joints && leads && o_.link->connected(); ++j) {
    asked_[static_cast<std::size_t>(j)] = kPosition;
    if (Try("position mode of joint " + Text(j + 1),
            [&] { o_.link->SetMode(j, Gen3Mode::Position); }))
      mode_[static_cast<std::size_t>(j)] = kPosition;
  }
  Try("the arm's own servoing", [&] { o_.link->SetServoing(Gen3Servoing::SingleLevel); });
}

/// The position commands stay what they were: a joint that leaves them behind is held by its
/// firmware.
void Gen3Arm::CarryAndHold() {
  ComputeDynamics(o_.model, sample_.position, JointVelocity::Zero(o_.model.joints()), work_);
  for (int j = 0; j < kGen3Joints; ++j) {
    Gen3Command::Actuator& a = command_.actuator[static_cast<std::size_t>(j)];
    const double v = age_ == 0 ? sample_.velocity(j) : 0;
    const double tau = work_.gravity(j) - kDampingOfLimit * torque_limit_(j) * v;
    a.position = OnWire(reference_(j));
    a.velocity = 0;
    a.torque = Within(tau, torque_limit_(j), a.torque);
    a.current = Within(tau / o_.torque_per_ampere(j), o_.current_limit(j), a.current);
  }
}

void Gen3Arm::HandBack() {
  const bool was_over = over_.exchange(true);
  services_.request_stop();
  if (was_over || !begun_) return;
  const std::size_t before = failures().size();
  const auto give_back = [this] {
    if (services_.joinable()) services_.join();
    GiveBack();
  };
  if (o_.lock_step.count() > 0) {
    give_back();
  } else {
    const auto carry = [this] {
      Latest();
      CarryAndHold();
      Send();
    };
    carry();  // before the first joint changes its mode
    std::atomic<bool> done{false};
    const std::jthread services([&] {
      give_back();
      done = true;
    });
    while (!done) {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds(o_.period)));
      if (!done) carry();
    }
  }
  std::string failed = failures().substr(before);
  if (failed.starts_with('\n')) failed.erase(0, 1);
  if (!failed.empty()) throw Error("the arm was not handed back whole\n" + failed);
}

std::string Gen3Arm::failures() const {
  const std::lock_guard lock(failures_mutex_);
  return failures_;
}

}  // namespace pliant
