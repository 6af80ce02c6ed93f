#include "pliant/analysis/compliance_claims.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/analysis/compliance_prediction.h"
#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

double LargestTurn(const RunData& run) {
  const Series& q = run["arm.measured_position"];
  return Largest((q.colwise() - q.col(0)).cwiseAbs());
}

/// The largest part of a limit that a joint used: of velocity, torque and, counted from the middle
/// of its range, of position. 1: all of it.
double UseOfLimits(const RunData& run, int joint) {
  const Joint& j = run.arm.model.joint(joint);
  const auto largest = [&](const char* path, double middle) {
    return Largest((run[path].row(joint).array() - middle).abs());
  };
  Eigen::Array3d use{largest("arm.measured_velocity", 0) / j.velocity,
                     largest("control.torque", 0) / j.effort, 0};
  if (j.type != Joint::Type::Continuous)
    use(2) =
        largest("arm.measured_position", 0.5 * (j.lower + j.upper)) / (0.5 * (j.upper - j.lower));
  return Largest(use);
}

/// How far the tool may stand off without anybody pushing [m]. At rest λ (τ_d − τ − b) + l ± s ± s
/// is left of a torque τ_d: its sensor is off by b, the leak l is at its clamp, stiction s and its
/// compensation may both be wrong. So each joint misses up to
///
///   (λ |b| + l_max + 2 s)/(1 + λ)
///
/// which pushes the tool against the stiffness of its pose; all of them at once, at worst.
double StaticOffset(const RunData& run) {
  const ComplianceControl::Options& o = ComplianceOf(run.control);
  const LowLevelTorque::Options loop =
      TorqueLoopOf(*o.low_level, std::get<ProposedTorqueLoop>(o.torque_loop));
  const PerJoint missing = (loop.lag_gain * run.arm.sensors.torque_bias.cwiseAbs() +
                            PerJoint(loop.leak_limit) + 2 * loop.friction.stiction) /
                           (1 + loop.lag_gain);
  Eigen::Matrix<double, 6, 1> worst = Eigen::Matrix<double, 6, 1>::Zero();
  for (int j = 0; j < o.model.size(); ++j)
    worst += TaskAcceleration(o.model, o.tool, o.position,
                              missing(j) * PerJoint::Unit(o.model.size(), j), o.rotor_inertia)
                 .cwiseAbs();
  return worst.tail<3>().norm() / o.pose.stiffness;
}

constexpr char kOffsetBasis[] =
    "the torque that friction, sensor offsets and the leak's clamp leave at rest, in all joints at "
    "once, against the pose's stiffness";

/// The tool of a run against `factor` times the prediction for the pushes it got.
struct ToolBound {
  ToolBound(const RunData& run, double allowed) : factor{allowed} {
    const Series predicted = PredictedError(run);
    const Series& error = run["control.pose_error"];
    shift = Largest(Norms(Linear(error))), predicted_shift = Largest(Norms(Linear(predicted)));
    turn = Largest(Norms(Angular(error))), predicted_turn = Largest(Norms(Angular(predicted)));
  }
  bool holds() const { return shift < factor * predicted_shift && turn < factor * predicted_turn; }
  std::string measured() const {
    return "tool " + WithUnit(shift, "m") + " (predicted " + WithUnit(predicted_shift, "m") +
           "), " + WithUnit(turn, "rad") + " (predicted " + WithUnit(predicted_turn, "rad") + ")";
  }

  double factor, shift, predicted_shift, turn, predicted_turn;
};

/// When the last push has lasted longest at its full force.
double EndOfPlateau(const Scenario& scenario) {
  const std::vector<Push::Options> pushes = PushesOf(scenario);
  Require(!pushes.empty(), "there is no !Push in the environment of its run");
  const auto last = std::ranges::max_element(pushes, {}, &Push::Options::start_s);
  return last->start_s + last->duration_s - last->edge_s;
}

/// What these claims are about.
void RequireCompliantTicks(const Scenario& scenario) {
  ComplianceOf(scenario.controller);
  RequireEveryTick(scenario);
}

/// With positions commanded, the controller's error is that of its reference, not of the arm.
void RequireTorque(const Scenario& scenario) {
  Require(ComplianceOf(scenario.controller).command == ArmCommand::Torque,
          "controller.command must be torque: with positions, control.pose_error is not the arm's");
}

}  // namespace

Series PredictedError(const RunData& run) {
  const ComplianceControl::Options& o = ComplianceOf(run.control);
  const Series a = TaskAcceleration(run.arm.model, o.tool, run["arm.measured_position"],
                                    run["true_torque.torque"], o.rotor_inertia);
  return DeviationBehindObserver(a, o.observer_gain, o.pose.damping, o.pose.stiffness,
                                 run.sample_period());
}

Series StaticError(const RunData& run) {
  const ComplianceControl::Options& o = ComplianceOf(run.control);
  return TaskAcceleration(run.arm.model, o.tool, run["arm.measured_position"],
                          run["true_torque.torque"], o.rotor_inertia) /
         o.pose.stiffness;
}

void StandsStill::RequireFit(const Scenario& scenario) const {
  RequireCompliantTicks(scenario);
  RequireTorque(scenario);
  const auto& control = std::get<ComplianceControl::Options>(scenario.controller);
  Require(std::holds_alternative<ProposedTorqueLoop>(control.torque_loop),
          "controller.torque_loop must be !Proposed: the bound is what that loop leaves at rest");
  Require(IsIdeal(scenario) || !StationOf(scenario).firmware.compensated,
          "station.ideal must be true: nobody says what the torque loop inside of robot '" +
              scenario.robot + "' leaves at rest");
}

Claim StandsStill::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const bool real = ComplianceOf(of.control).low_level.has_value();
  const double turn = LargestTurn(of), shift = Largest(Norms(Linear(of["control.pose_error"])));
  // Ideal: the states are at rest, so the integrator adds nothing; what its tolerance would allow
  // is the bound.
  const double bound = real ? StaticOffset(of) : of.scenario.integrator.absolute_tolerance;
  return claim.Stated(
      "joints " + WithUnit(turn, "rad") + ", tool " + WithUnit(shift, "m"),
      real ? "tool below " + WithUnit(bound, "m") + "; the null space has no stiffness"
           : "below " + WithUnit(bound, "rad") + " and " + WithUnit(bound, "m"),
      real ? kOffsetBasis
           : "the integrator's absolute tolerance; round-off alone leaves some 1e-15",
      shift < bound && (real || turn < bound));
}

void HoldsTool::RequireFit(const Scenario& scenario) const {
  RequireCompliantTicks(scenario);
  RequireTorque(scenario);
}

Claim HoldsTool::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const ToolBound tool(of, factor);
  const ComplianceControl::Options& o = ComplianceOf(of.control);
  const double turn = LargestTurn(of) * kDegrees;
  const bool moves = joints_more_than_deg > 0;
  return claim.Stated(
      (moves ? "joints " + Text(std::round(10 * turn) / 10) + "°; " : "") + tool.measured(),
      (moves ? "joints more than " + Text(joints_more_than_deg) + "°; " : "") + "tool below " +
          Text(factor) + " times the predicted peaks",
      (moves ? Text(joints_more_than_deg) + "°: well above what the stiff run moves; " : "") +
          "s/((s + " + Text(o.observer_gain) + ")(s² + " + Text(o.pose.damping) + " s + " +
          Text(o.pose.stiffness) + ")) applied to the recorded J M⁻¹ τ_e; " + Text(factor) +
          " leaves room for J̇ and the posture's weight",
      tool.holds() && turn >= joints_more_than_deg);
}

void YieldsAsInertia::RequireFit(const Scenario& scenario) const {
  RequireCompliantTicks(scenario);
  const double end = EndOfPlateau(scenario);
  Require(scenario.duration_s >= end,
          "duration_s must be >= " + Text(end) + ", when its last push has lasted",
          scenario.duration_s);
}

Claim YieldsAsInertia::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const Eigen::Index k =
      std::ranges::lower_bound(of.times(), EndOfPlateau(of.scenario)) - of.times().begin();
  const Series& p = of["tool.position"];
  const Eigen::Vector3d e = p.col(k) - p.col(0);  // of the tool itself, whatever is commanded
  const Eigen::Vector3d expected = StaticError(of).col(k).tail(3);
  const double off = (e - expected).norm() / expected.norm();
  const std::string stiffness = Text(ComplianceOf(of.control).pose.stiffness);
  return claim.Stated(
      "tool " + WithUnit(e.norm(), "m") + ", Λ⁻¹F/" + stiffness + " is " +
          WithUnit(expected.norm(), "m") + "; they differ by " + Text(std::round(1000 * off) / 10) +
          " %",
      "they differ by less than " + Text(100 * within) + " %, as vectors",
      "EC (9) at rest, Λ at the measured q, at the end of the push's plateau, when the "
      "transients of s² + " +
          Text(ComplianceOf(of.control).pose.damping) + " s + " + stiffness + " are over; " +
          Text(100 * within) + " % leaves room for the drift of the null space",
      off < within);
}

void KeepsLimits::RequireFit(const Scenario& scenario) const { RequireCompliantTicks(scenario); }

Claim KeepsLimits::Check(const Runs& runs) const {
  double most = 0;
  std::string where;
  Eigen::Index relaxed = 0, fallback = 0;
  for (const RunData* run : runs.all()) {
    const Eigen::VectorXd outcome = run->log["control.report"]["outcome"];
    using Outcome = ComplianceQpReport::Outcome;
    relaxed += (outcome.array() == static_cast<double>(Outcome::Relaxed)).count();
    fallback += (outcome.array() == static_cast<double>(Outcome::Fallback)).count();
    for (int j = 0; j < run->arm.model.size(); ++j) {
      const double use = UseOfLimits(*run, j);
      // What is not a number is worse than all.
      if (!(use <= most) && !std::isnan(most))
        most = use, where = run->arm.model.joint(j).name + ", " + run->title;
    }
  }
  return claim.Stated("at most " + Text(std::round(1000 * most) / 10) + " % of a limit (" + where +
                          "); limits given up in " + Text(relaxed) + " ticks, fallback in " +
                          Text(fallback),
                      "below 100 % of every position, velocity and torque limit; none given up",
                      "the limits of the robot's model", most < 1 && relaxed == 0 && fallback == 0);
}

}  // namespace pliant
