#include "pliant/controllers/friction_excitation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

/// Part of v_max at which a level counts as having reached it.
constexpr double kReached = 0.95;
/// Where references come near their ends: d = p_r (r° − r) instead of a square root [1/s].
constexpr double kApproach = 8;
/// How near, and how slow, is there.
constexpr double kThere = 1e-3;
/// For how long, before a test begins [s].
constexpr double kRest = 0.3;
/// v₀ [rad/s].
constexpr double kSmooth = 0.02;
/// Largest p³ ∫e dt [rad/s²].
constexpr double kMostIntegral = 20;

std::vector<int> TestedJoints(const FrictionExcitation::Options& o) {
  std::vector<int> joints;
  for (const std::string& name : o.test.joints) {
    joints.push_back(o.model.joint_index(name));
    Require(std::ranges::count(joints, joints.back()) == 1, "joints names each joint once", name);
  }
  if (joints.empty())
    for (int j = 0; j < o.model.size(); ++j) joints.push_back(j);
  return joints;
}

/// From rest to rest, and a rest.
double TimeOf(double way, double speed, double acceleration) {
  const bool reaches_speed = way > speed * speed / acceleration;
  return (reaches_speed ? way / speed + speed / acceleration : 2 * std::sqrt(way / acceleration)) +
         3 / kApproach + kRest;
}

/// Of a joint that brakes with `deceleration`, and gently in the end.
double SpeedToStopWithin(double way, double deceleration) {
  const double gentle = deceleration / (kApproach * kApproach);
  return way < gentle ? kApproach * way : std::sqrt(2 * deceleration * (way - gentle / 2));
}

}  // namespace

FrictionExcitation::FrictionExcitation(const Options& o)
    : position{this, "position", o.model.joints()},
      velocity{this, "velocity", o.model.joints()},
      torque{this, "torque", o.model.joints()},
      dynamics{this, "dynamics", o.model.joints()},
      temperature{this, "temperature", o.model.joints(), JointTemperature::Zero(o.model.joints())},
      current{this, "current", o.model.joints()},
      motor_torque{this, "motor_torque", o.model.joints()},
      reference{this, "reference", o.model.joints()},
      break_away_up{this, "break_away_up", o.model.joints()},
      break_away_down{this, "break_away_down", o.model.joints()},
      report{this, "report"},
      o_{o},
      h_{seconds(o.period)},
      joints_{TestedJoints(o)},
      state_{this, "state", {}, AtRest(o)} {
  const Joints& all = o.model.joints();
  RequireInRange("", o.test);
  Require(o.test.velocity_limit > o.test.speed,
          "velocity_limit must be > speed = " + Text(o.test.speed) + ", which is reached",
          o.test.velocity_limit);
  RequireEachInRange("start", o.start, "rad", kAnyNumber, all);
  RequireEachInRange("torque_per_ampere", o.torque_per_ampere, "N·m/A", kPositive, all);
  RequireEachInRange("coulomb", o.coulomb, "N·m", kPositive, all);
  RequireEachInRange("viscous", o.viscous, "N·m·s/rad", kPositive, all);
  for (int j = 0; j < o.model.size(); ++j) {
    const Joint& joint = o.model.joint(j);
    Require(std::isfinite(joint.velocity) && std::isfinite(joint.effort),
            "joints have limits of velocity and torque", "none for " + joint.name);
    if (HasLimits(j))
      Require(joint.lower < o.start(j) && o.start(j) < joint.upper,
              "start lies between the limits of " + joint.name, o.start(j));
  }
  Every(o.period)
      .Compute(state_)
      .From(state_, position, velocity, torque, dynamics, temperature)
      .As(&FrictionExcitation::Next);
  Compute(current).From(state_).As(&FrictionExcitation::Current);
  Compute(motor_torque).From(state_).As([](const State& s) { return JointTorque(s.torque); });
  Compute(reference).From(state_).As([](const State& s) { return JointPosition(s.reference); });
  Compute(break_away_up).From(state_).As([](const State& s) { return JointTorque(s.up); });
  Compute(break_away_down).From(state_).As([](const State& s) { return JointTorque(s.down); });
  Compute(report).From(state_).As([](const State& s) { return s.report; });
}

FrictionExcitation::State FrictionExcitation::AtRest(const Options& o) {
  const PerJoint none = PerJoint::Zero(o.model.size());
  State s{.report = {},
          .reference = o.start,
          .rate = none,
          .acceleration = none,
          .integral = none,
          .up = none,
          .down = none,
          .weight = none,
          .torque = none};
  s.report.joint = TestedJoints(o).front();
  return s;
}

double FrictionExcitation::LengthOf(const Options& o) {
  const FrictionTest& t = o.test;
  double length = kRest;
  for (const int j : TestedJoints(o)) {
    const Joint& joint = o.model.joint(j);
    const double top = t.speed * joint.velocity, a = t.acceleration;
    length += 2 * t.break_aways * (t.ramp_s + TimeOf(0.1, top / 2, a));
    if (joint.type == Joint::Type::Continuous) {
      length += 2 * ((t.speeds + 1) * (t.settle_s + t.dwell_s) + top / a +
                     TimeOf(std::numbers::pi, top / 2, a));
      continue;
    }
    length += 2 * TimeOf(t.range * (joint.upper - joint.lower), top / 2, a);
    for (int k = 1; k <= t.speeds; ++k)
      length += 2 * (t.settle_s + t.dwell_s + 2 * top * k / t.speeds / a);
  }
  return length;
}

bool FrictionExcitation::HasLimits(int joint) const {
  return o_.model.joint(joint).type != Joint::Type::Continuous;
}

double FrictionExcitation::Top(int joint) const {
  return o_.test.speed * o_.model.joint(joint).velocity;
}

/// Where a sweep turns.
double FrictionExcitation::Bound(int joint, int way) const {
  const Joint& j = o_.model.joint(joint);
  return o_.start(joint) + o_.test.range * ((way > 0 ? j.upper : j.lower) - o_.start(joint));
}

/// to − from; without whole turns where these do not count.
double FrictionExcitation::Away(int joint, double to, double from) const {
  return HasLimits(joint) ? to - from : std::remainder(to - from, 2 * std::numbers::pi);
}

bool FrictionExcitation::DrivenByCurrent(const State& s, int joint) const {
  return joint == s.report.joint &&
         (s.report.phase == FrictionPhase::BreakAway || s.report.phase == FrictionPhase::Staircase);
}

void FrictionExcitation::Stop(State& s, FrictionStop why, int joint, const JointPosition& q,
                              const JointVelocity& v) const {
  s.report.phase = FrictionPhase::Stopped;
  s.report.steady = false;
  s.report.stop = why;
  s.report.stopped_by = joint;
  s.reference = q;
  s.rate = v;
  s.integral.setZero();
}

void FrictionExcitation::Check(State& s, const JointPosition& q, const JointVelocity& v,
                               const JointTemperature& T) const {
  const FrictionTest& t = o_.test;
  for (int j = 0; j < o_.model.size(); ++j) {
    const double off = DrivenByCurrent(s, j) ? 0 : std::abs(Away(j, s.reference(j), q(j)));
    const bool out = HasLimits(j) && (q(j) > Bound(j, 1) + t.position_tolerance ||
                                      q(j) < Bound(j, -1) - t.position_tolerance);
    const FrictionStop why = std::abs(v(j)) > t.velocity_limit * o_.model.joint(j).velocity
                                 ? FrictionStop::Velocity
                             : off > t.position_tolerance || out ? FrictionStop::Position
                             : T(j) > t.temperature_limit        ? FrictionStop::Temperature
                                                                 : FrictionStop::None;
    if (why != FrictionStop::None) return Stop(s, why, j, q, v);
  }
  if (s.report.phase == FrictionPhase::Done) return;
  if (s.joint_ticks * h_ > t.joint_time_limit_s)
    Stop(s, FrictionStop::Time, s.report.joint, q, v);
  else if (s.all_ticks * h_ > t.time_limit_s)
    Stop(s, FrictionStop::Time, -1, q, v);
}

/// The part of the test whose place is reached.
void FrictionExcitation::Begin(State& s, const JointPosition& q) const {
  const int j = s.report.joint;
  s.ticks = 0;
  s.level = 1;
  s.way = 1;
  s.speed_sum = 0;
  s.origin = q(j);
  s.report.phase = s.part < 2 * o_.test.break_aways ? FrictionPhase::BreakAway
                   : HasLimits(j)                   ? FrictionPhase::Sweep
                                                    : FrictionPhase::Staircase;
}

/// Goes on to the next part, or to the next joint.
void FrictionExcitation::Finish(State& s) const {
  const int parts = 2 * o_.test.break_aways + (HasLimits(s.report.joint) ? 1 : 2);
  s.report.phase = FrictionPhase::Return;
  s.report.steady = false;
  s.ticks = 0;
  if (++s.part < parts) return;
  s.part = 0;
  s.joint_ticks = 0;
  if (++s.test < static_cast<int>(joints_.size()))
    s.report.joint = joints_[static_cast<std::size_t>(s.test)];
}

void FrictionExcitation::Advance(State& s, const JointPosition& q, const JointVelocity& v) const {
  const FrictionTest& t = o_.test;
  const int j = s.report.joint;
  const int way = s.part % 2 == 0 ? 1 : -1;
  if (s.report.phase == FrictionPhase::Done || s.report.phase == FrictionPhase::Stopped) return;
  ++s.joint_ticks;
  ++s.all_ticks;
  ++s.ticks;
  // A joint that was driven by current is taken over where it is, as fast as it is.
  const auto finish = [&] {
    s.reference(j) = q(j);
    s.rate(j) = v(j);
    s.integral(j) = 0;
    Finish(s);
  };
  switch (s.report.phase) {
    case FrictionPhase::BreakAway: {
      const double ramp = Ramp(s);
      if (ramp > o_.model.joint(j).effort) return Stop(s, FrictionStop::Stuck, j, q, v);
      if (way * Away(j, q(j), s.origin) < t.break_angle) return;
      PerJoint& mean = way > 0 ? s.up : s.down;
      const int before = s.part / 2;
      mean(j) += (ramp - mean(j)) / (before + 1);
      return finish();
    }
    case FrictionPhase::Staircase: {
      const double elapsed = s.ticks * h_, top = Top(j);
      const double most = 0.5 * (top + t.velocity_limit * o_.model.joint(j).velocity);
      if (way * v(j) > most) return finish();
      s.report.steady = elapsed > t.settle_s;
      if (s.report.steady) s.speed_sum += way * v(j);
      if (elapsed < t.settle_s + t.dwell_s) return;
      const double counted = std::max(1.0, std::floor(t.dwell_s / h_));
      if (s.speed_sum / counted >= kReached * top || s.level >= 2 * t.speeds) return finish();
      ++s.level;
      s.ticks = 0;
      s.speed_sum = 0;
      s.report.steady = false;
      return;
    }
    case FrictionPhase::Sweep: {
      const double speed = s.way * Top(j) * s.level / t.speeds;
      const bool constant = std::abs(s.rate(j) - speed) < 1e-9;
      const bool near = std::abs(Bound(j, s.way) - s.reference(j)) < kThere;
      const bool slows = !constant && s.ticks > 1 && s.way * s.acceleration(j) < 0;
      if (!constant) s.ticks = std::min(s.ticks, 1);
      const double elapsed = (s.ticks - 1) * h_;
      s.report.steady = constant && elapsed > t.settle_s;
      if (!(near || slows || elapsed > t.settle_s + t.dwell_s)) return;
      s.report.steady = false;
      s.ticks = 0;
      s.way = -s.way;
      if (s.way < 0) return;
      if (++s.level > t.speeds) Finish(s);
      return;
    }
    case FrictionPhase::Return: {
      if (!IsThere(s)) s.ticks = 0;
      if (s.ticks * h_ < kRest) return;
      if (s.test == static_cast<int>(joints_.size())) {
        s.report.phase = FrictionPhase::Done;
        return;
      }
      return Begin(s, q);
    }
    case FrictionPhase::Done:
    case FrictionPhase::Stopped:
      return;
  }
}

/// Where a joint is to be when nothing is tested.
double FrictionExcitation::PlaceOf(const State& s, int joint) const {
  const bool sweep_is_next = s.test < static_cast<int>(joints_.size()) && joint == s.report.joint &&
                             HasLimits(joint) && s.part >= 2 * o_.test.break_aways;
  return sweep_is_next ? Bound(joint, -1) : o_.start(joint);
}

bool FrictionExcitation::IsThere(const State& s) const {
  for (int j = 0; j < o_.model.size(); ++j)
    if (std::abs(Away(j, PlaceOf(s, j), s.reference(j))) > kThere || std::abs(s.rate(j)) > kThere)
      return false;
  return true;
}

void FrictionExcitation::MoveReference(State& s, const JointPosition& q) const {
  const double most = o_.test.acceleration;
  for (int j = 0; j < o_.model.size(); ++j) {
    if (DrivenByCurrent(s, j)) {
      s.reference(j) = q(j);
      s.rate(j) = s.acceleration(j) = 0;
      continue;
    }
    double wanted = 0;
    if (s.report.phase != FrictionPhase::Stopped) {
      const bool sweeps = s.report.phase == FrictionPhase::Sweep && j == s.report.joint;
      const double speed = sweeps ? Top(j) * s.level / o_.test.speeds : Top(j) / 2;
      const double d = Away(j, sweeps ? Bound(j, s.way) : PlaceOf(s, j), s.reference(j));
      wanted = std::copysign(std::min(speed, SpeedToStopWithin(std::abs(d), most)), d);
    }
    s.acceleration(j) = std::clamp((wanted - s.rate(j)) / h_, -most, most);
    s.rate(j) += h_ * s.acceleration(j);
    s.reference(j) += h_ * s.rate(j);
  }
}

void FrictionExcitation::Drive(State& s, const JointPosition& q, const JointVelocity& v,
                               const RobotDynamics& d) const {
  const double p = o_.test.bandwidth;
  const int n = o_.model.size();
  PerJoint a = PerJoint::Zero(n), friction = a;
  for (int j = 0; j < n; ++j) {
    if (DrivenByCurrent(s, j)) continue;
    const double e = Away(j, s.reference(j), q(j));
    s.integral(j) = std::clamp(s.integral(j) + h_ * p * p * p * e, -kMostIntegral, kMostIntegral);
    a(j) = s.acceleration(j) + 3 * p * (s.rate(j) - v(j)) + 3 * p * p * e + s.integral(j);
    friction(j) = o_.coulomb(j) * std::tanh(s.rate(j) / kSmooth) + o_.viscous(j) * s.rate(j);
  }
  s.weight = d.gravity;
  s.torque.noalias() = d.M * a;
  s.torque += d.coriolis + d.gravity + friction;
  const int tested = s.report.joint;
  if (DrivenByCurrent(s, tested)) {
    const int way = s.part % 2 == 0 ? 1 : -1;
    const double broke = (way > 0 ? s.up : s.down)(tested);
    const double drive = s.report.phase == FrictionPhase::BreakAway
                             ? Ramp(s)
                             : (broke > 0 ? broke : o_.coulomb(tested)) +
                                   o_.viscous(tested) * Top(tested) * s.level / o_.test.speeds;
    s.torque(tested) = d.gravity(tested) + way * drive;
  }
  for (int j = 0; j < n; ++j) {
    const double effort = o_.model.joint(j).effort;
    s.torque(j) = std::clamp(s.torque(j), -effort, effort);
  }
}

/// ĉ t/ramp_s.
double FrictionExcitation::Ramp(const State& s) const {
  return o_.coulomb(s.report.joint) * s.ticks * h_ / o_.test.ramp_s;
}

FrictionExcitation::State FrictionExcitation::Next(const State& last, const JointPosition& q,
                                                   const JointVelocity& v, const JointTorque& tau,
                                                   const RobotDynamics& d,
                                                   const JointTemperature& T) const {
  State s = last;
  const PerJoint sum = q + v + tau + T;
  if (!(sum.allFinite() && d.gravity.allFinite() && d.coriolis.allFinite() && d.M.allFinite())) {
    int by = 0;
    while (by < sum.size() && std::isfinite(sum(by))) ++by;
    if (s.report.phase != FrictionPhase::Stopped)
      Stop(s, FrictionStop::NotFinite, by < sum.size() ? by : -1, s.reference, s.rate);
    s.known = false;
    s.torque = s.weight;
    return s;
  }
  if (!s.known) {  // the first sample, or the first after some that were no numbers
    s.reference = q;
    s.rate = v;
    s.integral.setZero();
    s.known = true;
  }
  if (s.report.phase != FrictionPhase::Stopped) Check(s, q, v, T);
  Advance(s, q, v);
  MoveReference(s, q);
  Drive(s, q, v, d);
  return s;
}

}  // namespace pliant
