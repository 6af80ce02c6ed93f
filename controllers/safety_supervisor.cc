#include "pliant/controllers/safety_supervisor.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

constexpr int kFresh = 3;                 // ticks; a velocity as old as that is none of now
constexpr double kRest_s = 0.2;           // at rest for so long, an arm is
constexpr double kFastestCommand = 1.5;   // of positions, of the joints' velocity limits
constexpr double kDampingOfLimit = 0.08;  // D per torque limit [s/rad]
constexpr double kLargestRate = 0.1;      // of D h/M_jj: far from shaking

/// These leave nothing to damp with, or the arm holds by itself already.
bool HoldsAtOnce(SafetyCause cause) {
  switch (cause) {
    case SafetyCause::NotConnected:
    case SafetyCause::ArmFault:
    case SafetyCause::JointFault:
    case SafetyCause::StaleFeedback:
    case SafetyCause::NotFinite:
    case SafetyCause::TorqueJump:  // torque control would go by a sensor that may be torn
    case SafetyCause::Mode:
      return true;
    default:
      return false;
  }
}

/// The element of x with the largest |x_j|/limit_j, NaN first.
template <class X>
Eigen::Index Worst(const X& x, const PerJoint& limit) {
  Eigen::Index worst = 0;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    if (!std::isfinite(x(j))) return j;
    if (std::abs(x(j)) * limit(worst) > std::abs(x(worst)) * limit(j)) worst = j;
  }
  return worst;
}

template <class X>
PerJoint Cut(const X& x, const PerJoint& limit) {
  return x.cwiseMin(limit).cwiseMax(-limit);
}

}  // namespace

SafetySupervisor::SafetySupervisor(const Options& o)
    : mode{this, "mode"},
      position_command{this, "position_command", o.model.joints(), o.position},
      torque_command{this, "torque_command", o.model.joints()},
      current_command{this, "current_command", o.model.joints()},
      measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      temperature{this, "temperature", o.model.joints(), JointTemperature::Zero(o.model.joints())},
      status{this, "status"},
      external_torque{this, "external_torque", o.model.joints(),
                      JointTorque::Zero(o.model.joints())},
      timing{this, "timing", {}, TickTiming{}},
      word{this, "word", {}, OperatorWord{}},
      arm_mode{this, "arm_mode"},
      arm_position{this, "arm_position", o.model.joints()},
      arm_torque{this, "arm_torque", o.model.joints()},
      arm_current{this, "arm_current", o.model.joints()},
      report{this, "report"},
      has_arm{this, "has_arm"},
      o_{o},
      h_{seconds(o.period)},
      lower_{o.model.lower_limit()},
      upper_{o.model.upper_limit()},
      v_max_{o.model.velocity_limit()},
      tau_max_{o.model.effort_limit()},
      i_max_{o.current_limit},
      D_{o.settings.damping.size() > 0 ? o.settings.damping
                                       : PerJoint(kDampingOfLimit * o.model.effort_limit())},
      seen_{this, "seen", {}, {}},
      memory_{this, "memory", {}, Before(o)},
      work_{this, "work", RobotDynamics(o.model)} {
  const Joints& joints = o.model.joints();
  RequireInRange("", o.settings);
  RequireOneForEach(joints, "position", o.position.size());
  RequireEachInRange("torque_per_ampere", o.torque_per_ampere, "N·m/A", kPositive, joints);
  RequireEachInRange("current_limit", o.current_limit, "A", kLimit, joints);
  RequireEachInRange("damping", D_, "N·m·s/rad", kNotNegative, joints);

  Compute(seen_)
      .From(mode, position_command, torque_command, current_command, measured_position,
            measured_velocity, measured_torque, temperature, status, external_torque, timing, word)
      .As([](Seen& seen, const ControlMode& mode, const JointPosition& q_d,
             const JointTorque& tau_d, const MotorCurrent& i_d, const JointPosition& q,
             const JointVelocity& v, const JointTorque& tau, const JointTemperature& temperature,
             const ArmStatus& status, const JointTorque& estimate, const TickTiming& timing,
             const OperatorWord& word) {
        seen = {mode, q_d, q, tau_d, tau, estimate, i_d, v, temperature, status, timing, word};
      });
  Every(o.period).Compute(memory_).From(memory_, work_, seen_).As(&SafetySupervisor::Next);
  Compute(arm_mode).From(memory_).As([](const Memory& m) { return m.mode; });
  Compute(arm_position).From(memory_).As([](const Memory& m) { return m.position; });
  Compute(arm_torque).From(memory_).As([](const Memory& m) { return m.torque; });
  Compute(arm_current).From(memory_).As([](const Memory& m) { return m.current; });
  Compute(report).From(memory_).As([](const Memory& m) { return m.report; });
  Compute(has_arm).From(memory_).As([](const Memory& m) {
    return m.report.state != SafetyState::Engaging && m.report.state != SafetyState::Running;
  });
}

SafetySupervisor::Memory SafetySupervisor::Before(const Options& o) {
  const Joints& joints = o.model.joints();
  Memory m;
  m.q = m.position = m.held = o.position;
  m.v = m.rate = JointVelocity::Zero(joints);
  m.tau = m.tau_d = m.torque = JointTorque::Zero(joints);
  m.i_d = m.current = MotorCurrent::Zero(joints);
  return m;
}

SafetySupervisor::Memory SafetySupervisor::Next(const Memory& last, RobotDynamics& work,
                                                const Seen& seen) const {
  Memory m = last;
  Count(m, seen);
  const Finding found = Look(m, seen);
  if (seen.q.allFinite()) m.q = seen.q;
  m.age = seen.status.age;
  if (seen.v.allFinite()) m.v = seen.v;
  if (seen.tau.allFinite()) m.tau = seen.tau;
  if (IsMode(seen.mode)) m.asked = seen.mode;
  if (seen.tau_d.allFinite()) m.tau_d = seen.tau_d;
  if (seen.i_d.allFinite()) m.i_d = seen.i_d;
  Move(m, seen, found);
  Command(m, seen, work);
  m.acknowledged = seen.word.acknowledged;
  m.started = true;
  return m;
}

void SafetySupervisor::Count(Memory& m, const Seen& seen) const {
  m.report.since += h_;
  m.missed = std::max(0.0, m.missed - o_.settings.most_missed * h_) +
             static_cast<double>(seen.timing.missed - m.counted);
  m.counted = seen.timing.missed;
  const bool rests = seen.v.cwiseAbs().maxCoeff() < o_.settings.rest_speed;
  m.rest = rests ? m.rest + h_ : 0;
  m.switching = IsReady(m, seen) ? 0 : m.switching + h_;
}

/// Whether the arm is in the mode it was told.
bool SafetySupervisor::IsThere(const Memory& m, const Seen& seen) const {
  return seen.status.mode == m.mode && seen.status.switching == 0;
}

/// Whether the controller may have the arm: it is in the mode, and near what it is to follow.
bool SafetySupervisor::IsReady(const Memory& m, const Seen& seen) const {
  return IsThere(m, seen) &&
         (m.mode != ControlMode::Position || m.report.state != SafetyState::Engaging ||
          (seen.q_d - seen.q).cwiseAbs().maxCoeff() <= o_.settings.tracking);
}

SafetySupervisor::Finding SafetySupervisor::LookAtArm(const Seen& seen) const {
  const ArmStatus& status = seen.status;
  if (!status.connected) return {.cause = SafetyCause::NotConnected};
  if (status.faulted)
    return {.cause = SafetyCause::JointFault, .joint = std::countr_zero(status.faulted)};
  if (status.arm_faulted) return {.cause = SafetyCause::ArmFault};
  if (status.age >= o_.settings.stale_after)
    return {.cause = SafetyCause::StaleFeedback,
            .value = static_cast<double>(status.age),
            .limit = static_cast<double>(o_.settings.stale_after)};
  return {};
}

SafetySupervisor::Finding SafetySupervisor::LookAtMeasurements(const Memory& m,
                                                               const Seen& seen) const {
  const Settings& s = o_.settings;
  for (int j = 0; j < o_.model.size(); ++j)
    if (!std::isfinite(seen.q(j)) || !std::isfinite(seen.v(j)) || !std::isfinite(seen.tau(j)))
      return {.cause = SafetyCause::NotFinite, .joint = j};
  for (int j = 0; j < o_.model.size(); ++j) {
    const double q = seen.q(j);
    const double lower = lower_(j) + s.position_margin, upper = upper_(j) - s.position_margin;
    if (q < lower || q > upper)
      return {.cause = SafetyCause::PositionLimit,
              .joint = j,
              .value = q,
              .limit = q < lower ? lower : upper};
    const auto check = [&](SafetyCause cause, double x, double limit) -> Finding {
      if (std::abs(x) <= limit) return {};
      return {.cause = cause, .joint = j, .value = x, .limit = limit};
    };
    for (const Finding& found :
         {check(SafetyCause::PositionJump, m.started ? q - m.q(j) : 0,
                s.position_jump + m.age * h_ * v_max_(j)),
          check(SafetyCause::VelocityLimit, seen.v(j), s.velocity_limit * v_max_(j)),
          check(SafetyCause::TorqueLimit, seen.tau(j), s.torque_limit * tau_max_(j)),
          check(SafetyCause::TorqueJump, m.started ? seen.tau(j) - m.tau(j) : 0,
                s.torque_jump * tau_max_(j)),
          check(SafetyCause::Divergence, seen.estimate(j), s.divergence * tau_max_(j))})
      if (found.cause != SafetyCause::None) return found;
    if (!(seen.temperature(j) <= s.temperature))
      return {.cause = SafetyCause::Temperature,
              .joint = j,
              .value = seen.temperature(j),
              .limit = s.temperature};
  }
  return {};
}

SafetySupervisor::Finding SafetySupervisor::LookAtCommands(const Memory& m,
                                                           const Seen& seen) const {
  const Settings& s = o_.settings;
  if (!IsMode(seen.mode)) return {.cause = SafetyCause::CommandNotFinite};
  const bool runs = m.report.state == SafetyState::Running && m.share > 0;
  for (int j = 0; j < o_.model.size(); ++j) {
    double x = 0, step = 0, limit = kUnbounded;
    switch (seen.mode) {
      case ControlMode::Position:
        x = seen.q_d(j);
        step = m.mode == seen.mode && m.share >= 1 ? x - m.position(j) : 0;
        limit = kFastestCommand * v_max_(j) * h_;
        break;
      case ControlMode::Torque:
      case ControlMode::TorqueHighVelocity:
        x = seen.tau_d(j);
        step = x - m.tau_d(j);
        limit = s.command_jump * tau_max_(j);
        break;
      case ControlMode::Current:
        x = seen.i_d(j);
        step = x - m.i_d(j);
        limit = s.command_jump * i_max_(j);
        break;
    }
    if (!std::isfinite(x)) return {.cause = SafetyCause::CommandNotFinite, .joint = j};
    if (runs && m.asked == seen.mode && std::abs(step) > limit)
      return {.cause = SafetyCause::CommandJump, .joint = j, .value = step, .limit = limit};
    if (runs && seen.mode == ControlMode::Position && m.mode == seen.mode &&
        std::abs(m.position(j) - seen.q(j)) > s.tracking)
      return {.cause = SafetyCause::Tracking,
              .joint = j,
              .value = m.position(j) - seen.q(j),
              .limit = s.tracking};
  }
  return {};
}

/// The gravest first.
SafetySupervisor::Finding SafetySupervisor::Look(const Memory& m, const Seen& seen) const {
  if (const Finding found = LookAtArm(seen); found.cause != SafetyCause::None) return found;
  if (const Finding found = LookAtMeasurements(m, seen); found.cause != SafetyCause::None)
    return found;
  if (seen.word.stop) return {.cause = SafetyCause::UserStop};
  if (const Finding found = LookAtCommands(m, seen); found.cause != SafetyCause::None) return found;
  if (m.missed > o_.settings.most_missed)
    return {.cause = SafetyCause::Overruns,
            .value = m.missed,
            .limit = static_cast<double>(o_.settings.most_missed)};
  if (m.switching > o_.settings.engage_s && IsThere(m, seen))
    return {.cause = SafetyCause::Tracking,
            .value = (seen.q_d - seen.q).cwiseAbs().maxCoeff(),
            .limit = o_.settings.tracking};
  if (m.switching > o_.settings.engage_s)
    return {.cause = SafetyCause::Mode, .value = m.switching, .limit = o_.settings.engage_s};
  return {};
}

void SafetySupervisor::Enter(Memory& m, SafetyState state) {
  m.report.state = state;
  m.report.since = 0;
  m.rest = 0;
  m.switching = 0;
  m.share = 0;
}

/// r begins where the arm is, or near it where position control has led it. What is wrong may be
/// the way that it was led: but for a stop that was asked for, the rate is the measured one.
void SafetySupervisor::Hold(Memory& m) const {
  const PerJoint lead = m.position - m.q;
  const PerJoint most = PerJoint::Constant(lead.size(), o_.settings.tracking);
  m.position = m.mode == ControlMode::Position ? PerJoint(m.q + Cut(lead, most)) : PerJoint(m.q);
  if (m.mode != ControlMode::Position || m.report.cause != SafetyCause::UserStop) m.rate = m.v;
  m.rate = Cut(m.rate, v_max_);
  Enter(m, SafetyState::Holding);
}

void SafetySupervisor::Engage(Memory& m) {
  m.held = m.mode == ControlMode::Position ? m.position : m.q;
  Enter(m, SafetyState::Engaging);
}

void SafetySupervisor::Move(Memory& m, const Seen& seen, const Finding& found) const {
  SafetyReport& report = m.report;
  const Settings& s = o_.settings;
  const bool acknowledged = m.started && seen.word.acknowledged != m.acknowledged;
  report.now = found.cause;
  const bool faulty = found.cause != SafetyCause::None;
  if (faulty && report.cause == SafetyCause::None) {
    report.cause = found.cause;
    report.joint = found.joint;
    report.value = found.value;
    report.limit = found.limit;
  }
  switch (report.state) {
    case SafetyState::Engaging:
    case SafetyState::Running:
      if (faulty) {
        if (HoldsAtOnce(found.cause) || m.mode == ControlMode::Position)
          Hold(m);
        else
          Enter(m, SafetyState::Damped);
      } else if (m.asked == m.mode && IsReady(m, seen)) {
        if (report.state == SafetyState::Engaging) Enter(m, SafetyState::Running);
        m.share = std::min(1.0, m.share + h_ / s.blend_s);
      } else if (report.state == SafetyState::Running) {
        Engage(m);
      }
      break;
    case SafetyState::Damped:
    case SafetyState::Holding:
      if (acknowledged && !faulty && report.cause != SafetyCause::UserStop) {
        report.cause = SafetyCause::None;
        Engage(m);
      } else if (report.state == SafetyState::Damped) {
        if (HoldsAtOnce(found.cause) || m.rest >= kRest_s || report.since >= s.damped_s) Hold(m);
      } else if (report.since >= s.hold_s ||
                 (report.cause == SafetyCause::UserStop && m.rest >= kRest_s && IsThere(m, seen))) {
        Enter(m, SafetyState::Stopped);
      }
      break;
    case SafetyState::Stopped:
      break;
  }
}

void SafetySupervisor::Command(Memory& m, const Seen& seen, RobotDynamics& work) const {
  const bool holds =
      m.report.state == SafetyState::Holding || m.report.state == SafetyState::Stopped;
  const bool has_controller =
      m.report.state == SafetyState::Engaging || m.report.state == SafetyState::Running;
  if (holds) {
    m.mode = ControlMode::Position;
    const PerJoint slower = PerJoint::Constant(m.rate.size(), o_.settings.deceleration * h_);
    m.rate -= Cut(m.rate, slower);
    for (int j = 0; j < o_.model.size(); ++j) {
      double& r = m.position(j);
      if (seen.status.switching >> j & 1) {  // until it is in position control, it moves on
        r = m.q(j);
        m.rate(j) = std::clamp(m.v(j), -v_max_(j), v_max_(j));
      } else {
        r = std::clamp(r + h_ * m.rate(j), std::min(lower_(j), m.q(j)),
                       std::max(upper_(j), m.q(j)));
      }
    }
  } else if (has_controller) {
    m.mode = m.asked;
    const PerJoint before = m.position;
    if (m.mode == ControlMode::Position && m.share >= 1)
      m.position = seen.q_d;
    else
      m.position = m.held + m.share * (seen.q_d.allFinite() ? PerJoint(seen.q_d - m.held)
                                                            : PerJoint::Zero(m.held.size()));
    m.rate = (m.position - before) / h_;
  }

  const double part = has_controller && m.mode != ControlMode::Position ? m.share : 0;
  if (part >= 1) {  // most ticks end here
    m.torque = Cut(m.tau_d, tau_max_);
    m.current = Cut(m.i_d, i_max_);
    return;
  }
  ComputeDynamics(o_.model, m.q, JointVelocity(PerJoint::Zero(m.q.size())), work);
  // An old velocity would brake a motion that is over.
  const PerJoint v =
      seen.status.age < kFresh ? PerJoint(m.v) : PerJoint(PerJoint::Zero(m.v.size()));
  const PerJoint D = D_.cwiseMin(kLargestRate / h_ * work.M.diagonal());
  const PerJoint damped = work.gravity - D.cwiseProduct(v);
  m.torque = Cut((1 - part) * damped + part * m.tau_d, tau_max_);
  m.current = Cut((1 - part) * damped.cwiseQuotient(o_.torque_per_ampere) + part * m.i_d, i_max_);
}

}  // namespace pliant
