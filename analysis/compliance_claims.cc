#include "pliant/analysis/compliance_claims.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pliant/analysis/compliance_prediction.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// Largest norm of rows [first, first + rows) over time.
double Peak(const Series& all, int first, int rows) {
  return all.middleRows(first, rows).colwise().norm().maxCoeff<Eigen::PropagateNaN>();
}

double LargestTurn(const RunData& run) {
  const Series& q = run["arm.measured_position"];
  return (q.colwise() - q.col(0)).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}

/// A claim as it is stated in all three places: file, report, verdict.
Claim Stated(const ClaimSource& source, std::string measured, std::string criterion,
             std::string basis, bool holds) {
  return {.id = source.id,
          .source = source.source,
          .paper = source.paper,
          .measured = std::move(measured),
          .criterion = std::move(criterion),
          .basis = std::move(basis),
          .holds = holds};
}

/// 1: the run used all of a limit; positions count from the middle of their range.
struct Use {
  double position = 0, velocity = 0, torque = 0;
  double most() const {
    return Eigen::Array3d(position, velocity, torque).maxCoeff<Eigen::PropagateNaN>();
  }
};

Use UseOfLimits(const RunData& run, int joint) {
  const Joint& j = run.arm.model.joint(joint);
  Use use{.velocity =
              run["arm.measured_velocity"].row(joint).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() /
              j.velocity,
          .torque = run["control.torque"].row(joint).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() /
                    j.effort};
  if (j.type != Joint::Type::Continuous) {
    const double middle = 0.5 * (j.lower + j.upper), half = 0.5 * (j.upper - j.lower);
    use.position = (run["arm.measured_position"].row(joint).array() - middle)
                       .abs()
                       .maxCoeff<Eigen::PropagateNaN>() /
                   half;
  }
  return use;
}

/// How far the tool may stand off without anybody pushing [m]. At rest λ (τ_d − τ − b) + l ± s ± s
/// is left of a torque τ_d: its sensor is off by b, the leak l is at its clamp, stiction s and its
/// compensation may both be wrong. So each joint misses up to
///
///   (λ |b| + l_max + 2 s)/(1 + λ)
///
/// which pushes the tool against the stiffness of its pose; all of them at once, at worst.
double StaticOffset(const RunData& run) {
  const ComplianceControl::Options& o = run.control;
  const LowLevelTorque::Options& loop = *o.low_level;
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
    shift = Peak(error, 3, 3), predicted_shift = Peak(predicted, 3, 3);
    turn = Peak(error, 0, 3), predicted_turn = Peak(predicted, 0, 3);
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

}  // namespace

Series PredictedError(const RunData& run) {
  const ComplianceControl::Options& o = run.control;
  const Series a = TaskAcceleration(run.arm.model, o.tool, run["arm.measured_position"],
                                    run["true_torque.torque"], o.rotor_inertia);
  return DeviationBehindObserver(a, o.observer_gain, o.pose.damping, o.pose.stiffness,
                                 run.scenario.log_period.value_or(o.period));
}

Series StaticError(const RunData& run) {
  const ComplianceControl::Options& o = run.control;
  return TaskAcceleration(run.arm.model, o.tool, run["arm.measured_position"],
                          run["true_torque.torque"], o.rotor_inertia) /
         o.pose.stiffness;
}

Claim StandsStill::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const bool real = of.control.low_level.has_value();
  const double turn = LargestTurn(of), shift = Peak(of["control.pose_error"], 3, 3);
  // Ideal: the states are at rest, so the integrator adds nothing; what its tolerance would allow
  // is the bound.
  const double bound = real ? StaticOffset(of) : of.scenario.integrator.absolute_tolerance;
  return Stated(claim, "joints " + WithUnit(turn, "rad") + ", tool " + WithUnit(shift, "m"),
                real ? "tool below " + WithUnit(bound, "m") + "; the null space has no stiffness"
                     : "below " + WithUnit(bound, "rad") + " and " + WithUnit(bound, "m"),
                real ? kOffsetBasis
                     : "the integrator's absolute tolerance; round-off alone leaves some 1e-15",
                shift < bound && (real || turn < bound));
}

Claim HoldsTool::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const ToolBound tool(of, factor);
  const ComplianceControl::Options& o = of.control;
  const double turn = LargestTurn(of) * kDegrees;
  const bool moves = joints_more_than_deg > 0;
  return Stated(
      claim, (moves ? "joints " + Text(std::round(10 * turn) / 10) + "°; " : "") + tool.measured(),
      (moves ? "joints more than " + Text(joints_more_than_deg) + "°; " : "") + "tool below " +
          Text(factor) + " times the predicted peaks",
      (moves ? Text(joints_more_than_deg) + "°: well above what the stiff run moves; " : "") +
          "s/((s + " + Text(o.observer_gain) + ")(s² + " + Text(o.pose.damping) + " s + " +
          Text(o.pose.stiffness) + ")) applied to the recorded J M⁻¹ τ_e; " + Text(factor) +
          " leaves room for J̇ and the posture's weight",
      tool.holds() && turn >= joints_more_than_deg);
}

void YieldsAsInertia::RequireFit(const Scenario& scenario) const {
  const double end = EndOfPlateau(scenario);
  Require(scenario.duration_s >= end,
          "duration_s must be >= " + Text(end) + ", when its last push has lasted",
          scenario.duration_s);
}

Claim YieldsAsInertia::Check(const Runs& runs) const {
  const RunData& of = runs[run];
  const Eigen::Index k =
      std::ranges::lower_bound(of.times(), EndOfPlateau(of.scenario)) - of.times().begin();
  const Eigen::Vector3d e = of["control.pose_error"].col(k).tail(3);
  const Eigen::Vector3d expected = StaticError(of).col(k).tail(3);
  const double off = (e - expected).norm() / expected.norm();
  const std::string stiffness = Text(of.control.pose.stiffness);
  return Stated(claim,
                "tool " + WithUnit(e.norm(), "m") + ", Λ⁻¹F/" + stiffness + " is " +
                    WithUnit(expected.norm(), "m") + "; they differ by " +
                    Text(std::round(1000 * off) / 10) + " %",
                "they differ by less than " + Text(100 * within) + " %, as vectors",
                "EC (9) at rest, Λ at the measured q, at the end of the push's plateau, when the "
                "transients of s² + " +
                    Text(of.control.pose.damping) + " s + " + stiffness + " are over; " +
                    Text(100 * within) + " % leaves room for the drift of the null space",
                off < within);
}

Claim KeepsLimits::Check(const Runs& runs) const {
  double most = 0;
  std::string where;
  Eigen::Index relaxed = 0, fallback = 0;
  for (const RunData* run : runs.all()) {
    const Eigen::VectorXd outcome = run->log["control.report"]["outcome"];
    relaxed += (outcome.array() == 1).count();
    fallback += (outcome.array() == 2).count();
    for (int j = 0; j < run->arm.model.size(); ++j) {
      const double use = UseOfLimits(*run, j).most();
      if (!(use <= most) && !std::isnan(most))
        most = use, where = run->arm.model.joint(j).name + ", " + run->title;
    }
  }
  return Stated(claim,
                "at most " + Text(std::round(1000 * most) / 10) + " % of a limit (" + where +
                    "); limits left out in " + Text(relaxed) + " ticks, fallback in " +
                    Text(fallback),
                "below 100 % of every position, velocity and torque limit; none left out",
                "the limits of the robot's model", most < 1 && relaxed == 0 && fallback == 0);
}

}  // namespace pliant
