#include "pliant/diagrams/gen3_body.h"

#include <ActuatorConfig.pb.h>
#include <ActuatorCyclic.pb.h>
#include <Base.pb.h>
#include <Common.pb.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pliant/plants/shared_file.h"

namespace pliant {

namespace {

namespace config = Kinova::Api::ActuatorConfig;
namespace base = Kinova::Api::Base;
namespace common = Kinova::Api::Common;
namespace cyclic = Kinova::Api::ActuatorCyclic;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFollowing = 5, kFollowingWarning = 3;  // [°]
constexpr double kBeyondLimit = 1 * kDegree;
constexpr double kAmbient = 25, kWarmth = 0.5, kWarmingTime = 600;  // [°C], [°C/A²], [s]
constexpr double kTorqueJump = 30, kEncoderJump = 2, kFollowingJump = 6, kOverspeed = 1.1;
constexpr int kSettling = 500;  // ticks until the gears, let go at the start, are at rest

constexpr std::size_t kAll = kGen3Joints;

int Index(std::size_t joint) { return static_cast<int>(joint); }

float Turned(double degrees) {
  const auto turned = static_cast<float>(degrees - 360 * std::floor(degrees / 360));
  return turned < 360 ? turned : 0;
}

bool Finite(const Gen3Command::Actuator& a) {
  return std::isfinite(a.position) && std::isfinite(a.velocity) && std::isfinite(a.torque) &&
         std::isfinite(a.current);
}

Gen3Body::Options WithPosition(Gen3Body::Options o) {
  Require(o.patience_ticks > 0, "patience_ticks must be > 0", o.patience_ticks);
  if (!o.model) o.model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  Require(o.model->size() == kGen3Joints, "the model of a Gen3 must have 7 joints",
          o.model->size());
  if (o.station.position.size() == 0)
    o.station.position = JointPosition(kDegree * JointPosition{0, 15, 180, -130, 0, 55, 90});
  RequireOneForEach(o.model->joints(), "position", o.station.position.size());
  for (int j = 0; j < kGen3Joints; ++j) {
    const double q = o.station.position(j);
    Require(q >= o.model->lower_limit()(j) && q <= o.model->upper_limit()(j),
            "position of " + o.model->joint(j).name + " must be within " +
                Text(o.model->lower_limit()(j)) + " … " + Text(o.model->upper_limit()(j)) + " rad",
            q);
  }
  for (const FaultOrder& fault : o.faults)
    Require(!fault.joint || *fault.joint <= kGen3Joints,
            "the joint of the fault " + fault.kind + " must be one of 1 … 7", *fault.joint);
  return o;
}

}  // namespace

const Gen3Body::Limits& Gen3Body::LimitsOf(std::size_t joint) {
  static constexpr Limits kLarge{120, 100, 104.5, 56.7}, kSmall{200, 180, 51.3, 29.4};
  return joint < 4 ? kLarge : kSmall;
}

Gen3Body::Gen3Body(const Options& o) : o_{WithPosition(o)} {
  SimulatedArm::Options station = SimulatedGen3(*o_.model, o_.station);
  station.firmware.mode = ControlMode::Position;
  DiagramBuilder b;
  arm_ = &b.Add<SimulatedArm>("arm", station);
  diagram_.emplace(b.Build());
  sim_.emplace(*diagram_, Simulator::Options{.integrator = {.method = Method::kCashKarp}});

  lower_ = model_lower_ = o_.model->lower_limit();
  upper_ = model_upper_ = o_.model->upper_limit();
  const Joints& joints = o_.model->joints();
  q_ = q_read_ = target_ = o_.station.position;
  v_read_ = JointVelocity::Zero(joints);
  tau_read_ = torque_ = JointTorque::Zero(joints);
  current_ = MotorCurrent::Zero(joints);
  modes_.fill(Gen3Mode::Position);
  heat_.fill(kAmbient);
  for (int k = 0; k < kSettling; ++k) Step();
  ticks_ = 0;
}

std::vector<FaultOrder::Kind> Gen3Body::Kinds() {
  return {{"actuator_fault", true}, {"following_error", true},
          {"overspeed", true},      {"torque_sensor_dead", true},
          {"torque_jump", true},    {"encoder_jump", true},
          {"frozen", false},        {"nan", false},
          {"emergency_stop", false}};
}

std::optional<double> Gen3Body::servoed() const {
  if (began_ < 0) return {};
  return static_cast<double>(ticks_ - began_) / 1000;
}

bool Gen3Body::Shows(const std::string& kind) const {
  const std::optional<double> t = servoed();
  return t && pliant::Shows(o_.faults, kind, *t);
}

bool Gen3Body::ShowsOf(const char* kind, std::size_t joint) const {
  const std::optional<double> t = servoed();
  return t && std::ranges::any_of(o_.faults, [&](const FaultOrder& fault) {
           return fault.joint == Index(joint) + 1 && fault.kind == kind && fault.At(*t);
         });
}

bool Gen3Body::in_fault() const {
  return feedback_.fault_a != 0 ||
         std::ranges::any_of(feedback_.actuator, [](const auto& a) { return a.fault_a != 0; });
}

bool Gen3Body::emergency_stopped() const {
  return (feedback_.fault_a & base::EMERGENCY_STOP_ACTIVATED) != 0;
}

void Gen3Body::EnterLowLevel() {
  if (in_fault() || servoing_ == Gen3Servoing::LowLevel) return;
  servoing_ = Gen3Servoing::LowLevel;
  if (began_ < 0) began_ = ticks_;
  silent_ = -1;
  last_id_.fill({});
  // Until the first command, what is there goes on.
  torque_ = sim_->Get(arm_->measured_torque);
  current_ = sim_->Get(arm_->measured_current);
  Tell();
}

void Gen3Body::LeaveLowLevel() {
  if (servoing_ != Gen3Servoing::LowLevel) return;
  Hold();
  Tell();
}

void Gen3Body::Hold() {
  servoing_ = Gen3Servoing::SingleLevel;
  modes_.fill(Gen3Mode::Position);
  target_ = q_;
}

void Gen3Body::SetMode(int joint, Gen3Mode mode) {
  if (servoing_ == Gen3Servoing::LowLevel) modes_[static_cast<std::size_t>(joint)] = mode;
}

void Gen3Body::ClearFaults() {
  feedback_.fault_a = 0;
  for (int j = 0; j < kGen3Joints; ++j) ClearFaults(j);
}

void Gen3Body::ClearFaults(int joint) {
  feedback_.actuator[static_cast<std::size_t>(joint)].fault_a = 0;
  upper_(joint) = std::max(model_upper_(joint), q_(joint) + kBeyondLimit);
  lower_(joint) = std::min(model_lower_(joint), q_(joint) - kBeyondLimit);
  if (q_(joint) <= model_upper_(joint)) upper_(joint) = model_upper_(joint);
  if (q_(joint) >= model_lower_(joint)) lower_(joint) = model_lower_(joint);
  Tell();
}

void Gen3Body::EmergencyStop() {
  FailBase(base::EMERGENCY_STOP_ACTIVATED);
  Tell();
}

void Gen3Body::Command(const Gen3Command& command, const Ids& ids, std::uint32_t frame_id,
                       std::uint32_t jitter_us) {
  feedback_.frame_id = frame_id;
  if (servoing_ != Gen3Servoing::LowLevel) return;
  silent_ = 0;
  for (std::size_t j = 0; j < kAll; ++j) {
    const Gen3Command::Actuator& asked = command.actuator[j];
    const auto id = static_cast<std::uint16_t>(ids[j]);
    const bool newer = !last_id_[j] || (id != *last_id_[j] &&
                                        static_cast<std::uint16_t>(id - *last_id_[j]) < 0x8000);
    if (!newer || !Finite(asked)) continue;
    last_id_[j] = id;
    feedback_.actuator[j].command_id = ids[j];
    feedback_.actuator[j].jitter_us = jitter_us;
    const int i = Index(j);
    target_(i) = q_(i) + kDegree * std::remainder(asked.position - q_read_(i) / kDegree, 360);
    torque_(i) = asked.torque;  // unlike the sensor, in the joint's direction: example 108
    current_(i) = asked.current;
  }
}

void Gen3Body::Step(bool late) {
  if (servoing_ == Gen3Servoing::LowLevel && silent_ >= 0 && !late && ++silent_ > o_.patience_ticks)
    FailBase(base::CYCLIC_DATA_JITTER);
  Drive();
  sim_->AdvanceThroughTick();
  ++ticks_;
  Measure();
  Check();
  Tell();
  if (o_.watch) o_.watch(*this);
}

void Gen3Body::Drive() {
  JointModes modes;
  // Joints that are not led by a position follow, so that holding begins without a jump.
  JointPosition position = q_;
  for (std::size_t j = 0; j < kAll; ++j) {
    const JointBits bit = JointBits{1} << j;
    if (modes_[j] == Gen3Mode::Position) position(Index(j)) = target_(Index(j));
    if (modes_[j] == Gen3Mode::Torque) modes.torque |= bit;
    if (modes_[j] == Gen3Mode::Current) modes.current |= bit;
    if (modes_[j] == Gen3Mode::TorqueHighVelocity) modes.torque_high_velocity |= bit;
  }
  sim_->Set(arm_->joint_modes, modes);
  sim_->Set(arm_->position_command, position);
  sim_->Set(arm_->torque_command, torque_);
  sim_->Set(arm_->current_command, current_);
}

void Gen3Body::Measure() {
  q_ = q_read_ = sim_->Get(arm_->measured_position);
  v_read_ = sim_->Get(arm_->measured_velocity);
  tau_read_ = sim_->Get(arm_->measured_torque);
  for (std::size_t j = 0; j < kAll; ++j) {
    const int i = Index(j);
    const double current = sim_->Get(arm_->measured_current)(i);
    heat_[j] += 1e-3 / kWarmingTime * (kAmbient + kWarmth * current * current - heat_[j]);
    if (o_.faults.empty()) continue;
    if (ShowsOf("torque_jump", j)) tau_read_(i) += kTorqueJump;
    if (ShowsOf("torque_sensor_dead", j)) tau_read_(i) = 0;
    if (ShowsOf("encoder_jump", j)) q_read_(i) += kEncoderJump * kDegree;
    if (ShowsOf("overspeed", j)) v_read_(i) = kOverspeed * LimitsOf(j).velocity * kDegree;
  }
}

void Gen3Body::Check() {
  const bool before = in_fault();
  if (Shows("emergency_stop")) FailBase(base::EMERGENCY_STOP_ACTIVATED);
  for (std::size_t j = 0; j < kAll; ++j) {
    const int i = Index(j);
    const Limits& limits = LimitsOf(j);
    const double v = std::abs(v_read_(i)) / kDegree, tau = std::abs(tau_read_(i));
    double away = 0;
    if (servoing_ == Gen3Servoing::LowLevel && silent_ >= 0)
      away = std::abs(target_(i) - q_(i)) / kDegree;
    if (ShowsOf("following_error", j)) away += kFollowingJump;
    if (q_(i) <= model_upper_(i)) upper_(i) = model_upper_(i);
    if (q_(i) >= model_lower_(i)) lower_(i) = model_lower_(i);

    feedback_.actuator[j].warning_a = (away > kFollowingWarning ? config::FOLLOWING_ERROR : 0) |
                                      (v > limits.velocity_warning ? config::MAXIMUM_VELOCITY : 0) |
                                      (tau > limits.torque_warning ? config::MAXIMUM_TORQUE : 0);
    if (before) continue;
    if (away > kFollowing) Fail(j, config::FOLLOWING_ERROR);
    if (v > limits.velocity) Fail(j, config::MAXIMUM_VELOCITY);
    if (tau > limits.torque) Fail(j, config::MAXIMUM_TORQUE);
    if (q_(i) > upper_(i)) Fail(j, config::JOINT_LIMIT_HIGH);
    if (q_(i) < lower_(i)) Fail(j, config::JOINT_LIMIT_LOW);
    if (ShowsOf("actuator_fault", j)) Fail(j, config::MOTOR_DRIVER_FAULT);
  }
}

void Gen3Body::Fail(std::size_t joint, std::uint32_t bit) {
  feedback_.actuator[joint].fault_a |= bit;
  FailBase(base::JOINT_FAULT);
}

void Gen3Body::FailBase(std::uint32_t bit) {
  feedback_.fault_a |= bit;
  if (servoing_ == Gen3Servoing::LowLevel) Hold();
}

void Gen3Body::Tell() {
  feedback_.arm_state = in_fault()                            ? common::ARMSTATE_IN_FAULT
                        : servoing_ == Gen3Servoing::LowLevel ? common::ARMSTATE_SERVOING_LOW_LEVEL
                                                              : common::ARMSTATE_SERVOING_READY;
  const bool frozen = Shows("frozen"), wild = Shows("nan");
  const MotorCurrent& current = sim_->Get(arm_->measured_current);
  for (std::size_t j = 0; j < kAll; ++j) {
    Gen3Feedback::Actuator& a = feedback_.actuator[j];
    const int i = Index(j);
    a.status_flags = cyclic::SERVOING | cyclic::MOTOR_INDEXED | cyclic::JOINT_INDEXED |
                     cyclic::DRIVE_BOARD_READY | (a.fault_a != 0 ? cyclic::MAJOR_FAULT : 0);
    if (frozen) continue;
    a.position = Turned(q_read_(i) / kDegree);
    a.velocity = static_cast<float>(v_read_(i) / kDegree);
    a.torque = static_cast<float>(-tau_read_(i));
    a.current = static_cast<float>(current(i));
    a.voltage = 24;
    a.motor_temperature = static_cast<float>(heat_[j]);
    a.core_temperature = static_cast<float>(kAmbient + 10);
    if (wild) {
      a.position = a.torque = std::numeric_limits<float>::quiet_NaN();
      a.velocity = std::numeric_limits<float>::infinity();
      a.current = -std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace pliant
