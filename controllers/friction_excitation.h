#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/plants/joint_temperature.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// What a FrictionExcitation does with the joint under test.
enum class FrictionPhase : std::uint8_t {
  Return,     ///< it goes to where the next part begins, and rests
  BreakAway,  ///< a slow ramp of current from rest
  Staircase,  ///< constant currents, one after the other
  Sweep,      ///< to and fro, at constant speeds
  Done,       ///< all joints are tested; the arm is held at the start
  Stopped,    ///< braked to rest and held, for a FrictionStop
};

/// Why a FrictionExcitation stopped.
enum class FrictionStop : std::uint8_t {
  None,
  NotFinite,    ///< a measurement is no number
  Velocity,     ///< a joint is too fast
  Position,     ///< a joint is out of its bounds, or not where it is held
  Temperature,  ///< a motor is too hot
  Stuck,        ///< the largest torque does not break a joint away
  Time,         ///< the test of a joint lasts too long
};

/// What a FrictionExcitation does, and with which joint.
struct FrictionReport {
  using Space = Nothing;
  static constexpr Quantity quantity{"friction report", ""};

  FrictionPhase phase = FrictionPhase::Return;
  int joint = 0;        ///< under test, from 0
  bool steady = false;  ///< it moves at a constant speed: a sample for the friction
  FrictionStop stop = FrictionStop::None;
  int stopped_by = -1;  ///< joint, from 0; −1: none in particular

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("phase", phase, "");
    f("joint", joint, "");
    f("steady", steady, "");
    f("stop", stop, "");
    f("stopped_by", stopped_by, "");
  }
  bool operator==(const FrictionReport&) const = default;
};

/// How the friction of the joints is excited.
struct FrictionTest {
  std::vector<std::string> joints = {};  ///< in this order; none: all
  double speed = 0.8;                    ///< largest of a test, as a part of the velocity limit
  int speeds = 8;                        ///< how many, evenly up to the largest, each both ways
  double settle_s = 0.5;                 ///< before a speed counts as constant
  double dwell_s = 0.5;                  ///< how long it is kept then
  double range = 0.7;         ///< of a joint with position limits: part of the way to each
  double acceleration = 4;    ///< of sweeps, of braking and on the way back [rad/s²]
  int break_aways = 2;        ///< ramps each way
  double ramp_s = 2;          ///< from 0 to the Coulomb friction that is assumed
  double break_angle = 1e-3;  ///< how far a joint turns before it counts as broken away [rad]
  /// p, of the loop that holds and moves joints [1/s]. 3 p is where it crosses 1: far below the
  /// resonance of elastic gears, which is at 260 rad/s of the Gen3's shoulder with its arm
  /// stretched.
  double bandwidth = 8;
  double velocity_limit = 1;        ///< stops, as a part of the joint's limit, > speed
  double position_tolerance = 0.1;  ///< stops, off the reference or beyond a bound [rad]
  double temperature_limit = 60;    ///< stops [°C]
  double joint_time_limit_s = 120;  ///< stops, of one joint
  double time_limit_s = 900;        ///< stops, of all

  template <class F>
  void Parameters(F&& f) {
    f("joints", joints);
    f("speed", speed, "", Between(0.01, 0.95));
    f("speeds", speeds, "", Between(1, 1000));
    f("settle_s", settle_s, "s", kNotNegative);
    f("dwell_s", dwell_s, "s", kPositive);
    f("range", range, "", Between(0.01, 0.95));
    f("acceleration", acceleration, "rad/s²", kPositive);
    f("break_aways", break_aways, "", Between(0, 1000));
    f("ramp_s", ramp_s, "s", kPositive);
    f("break_angle", break_angle, "rad", kPositive);
    f("bandwidth", bandwidth, "1/s", kPositive);
    f("velocity_limit", velocity_limit, "", Between(0.01, 1));
    f("position_tolerance", position_tolerance, "rad", kPositive);
    f("temperature_limit", temperature_limit, "°C", kPositive);
    f("joint_time_limit_s", joint_time_limit_s, "s", kPositive);
    f("time_limit_s", time_limit_s, "s", kPositive);
  }
};

/// Motor currents that show the friction of one joint after the other, every h. With κ the torque
/// per ampere behind the gear and i = τ_m/κ, the joint under test gets
///
///   BreakAway   τ_m = g ± ĉ t/ramp_s       until it turns by break_angle, at τ_b
///   Staircase   τ_m = g ± (τ_b + d̂ v_k)    v_k = k v_max/N, k = 1, 2, … until v_max is reached
///   Sweep       r goes to and fro at v_k
///
/// the second if it has no position limits, the third, between bounds, if it has some. In a sweep,
/// on the way back and while others are tested a joint follows its reference r:
///
///   τ_m = (M + B) a + C q̇ + g + ĉ tanh(ṙ/v₀) + d̂ ṙ
///   a = r̈ + 3 p ė + 3 p² e + p³ ∫e dt
///   e = r − q
///
/// ĉ, d̂ are the friction that is assumed: τ_b is measured, each way by itself, so ĉ sets the pace
/// of the ramps only, and a wrong d̂ makes more or fewer steps. References keep to the acceleration;
/// the turns of joints without limits do not count.
///
/// When something is out of its limits all joints are braked to rest at the acceleration, and held
/// there; where measurements are no numbers the motors carry the last weight that was known. What
/// stopped it is reported, and nothing is started again.
///
/// Source: Muraccioli et al. 2025 (RSS), friction identification; computed torque with integral:
/// Siciliano et al., Robotics, 2009, ch. 8.5.
class FrictionExcitation final : public Block {
 public:
  struct Options {
    RobotModel model;            ///< the controller's
    JointPosition start;         ///< where the arm is and comes back to: without weight at best
    PerJoint torque_per_ampere;  ///< κ [N·m/A], each > 0
    PerJoint coulomb;            ///< ĉ [N·m], each > 0
    PerJoint viscous;            ///< d̂ [N·m·s/rad], each > 0
    FrictionTest test = {};
    Duration period;  ///< h
  };

  explicit FrictionExcitation(const Options& o);

  /// How long it takes, if the friction is the one that is assumed [s].
  static double LengthOf(const Options& o);

  Input<JointPosition> position;        ///< q
  Input<JointVelocity> velocity;        ///< q̇
  Input<JointTorque> torque;            ///< τ, behind the gears
  Input<RobotDynamics> dynamics;        ///< at q, q̇, with B in M
  Input<JointTemperature> temperature;  ///< taken for 0 if not connected
  Output<MotorCurrent> current;         ///< i
  Output<JointTorque> motor_torque;     ///< κ i
  Output<JointPosition> reference;      ///< r; q of a joint that has none
  Output<JointTorque> break_away_up;    ///< mean τ_b of the ramps so far; 0: none
  Output<JointTorque> break_away_down;
  Output<FrictionReport> report;

 private:
  struct State {
    FrictionReport report;
    int test = 0;   ///< which joint of the list
    int part = 0;   ///< of its test: ramps, then staircases or sweeps
    int level = 1;  ///< k
    int way = 1;    ///< of a sweep
    int ticks = 0;  ///< of the phase, or at a level
    int joint_ticks = 0;
    int all_ticks = 0;
    double speed_sum = 0;                    ///< of a level, since it settled
    double origin = 0;                       ///< q where the ramp begins
    bool known = false;                      ///< the last measurements were numbers
    PerJoint reference, rate, acceleration;  ///< r, ṙ, r̈
    PerJoint integral;                       ///< p³ ∫e dt
    PerJoint up, down;                       ///< τ_b
    PerJoint weight;                         ///< g, the last one known
    PerJoint torque;                         ///< τ_m

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("report", report, "");
      f("test", test, "");
      f("part", part, "");
      f("level", level, "");
      f("way", way, "");
      f("ticks", ticks, "");
      f("joint_ticks", joint_ticks, "");
      f("all_ticks", all_ticks, "");
      f("speed_sum", speed_sum, "rad/s");
      f("origin", origin, "rad");
      f("known", known, "");
      f("reference", reference, "rad");
      f("rate", rate, "rad/s");
      f("acceleration", acceleration, "rad/s²");
      f("integral", integral, "rad/s²");
      f("up", up, "N·m");
      f("down", down, "N·m");
      f("weight", weight, "N·m");
      f("torque", torque, "N·m");
    }
  };

  static State AtRest(const Options& o);
  State Next(const State& last, const JointPosition& q, const JointVelocity& v,
             const JointTorque& tau, const RobotDynamics& d, const JointTemperature& T) const;

  MotorCurrent Current(const State& s) const {
    return s.torque.cwiseQuotient(o_.torque_per_ampere);
  }

  bool HasLimits(int joint) const;
  double Top(int joint) const;  ///< v_max
  double Bound(int joint, int way) const;
  double Away(int joint, double to, double from) const;
  bool DrivenByCurrent(const State& s, int joint) const;

  void Check(State& s, const JointPosition& q, const JointVelocity& v,
             const JointTemperature& T) const;
  void Stop(State& s, FrictionStop why, int joint, const JointPosition& q,
            const JointVelocity& v) const;
  void Advance(State& s, const JointPosition& q, const JointVelocity& v) const;
  void Begin(State& s, const JointPosition& q) const;
  void Finish(State& s) const;
  double PlaceOf(const State& s, int joint) const;
  bool IsThere(const State& s) const;
  double Ramp(const State& s) const;
  void MoveReference(State& s, const JointPosition& q) const;
  void Drive(State& s, const JointPosition& q, const JointVelocity& v,
             const RobotDynamics& d) const;

  const Options o_;
  const double h_;
  const std::vector<int> joints_;
  Output<State> state_;
};

}  // namespace pliant
