#include "pliant/analysis/null_space_compliance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "pliant/analysis/compliance_prediction.h"
#include "pliant/analysis/with_unit.h"
#include "pliant/diagrams/compliance_loop.h"
#include "pliant/diagrams/stations.h"
#include "pliant/plants/model_file.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/simulator.h"

namespace pliant {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr char kTool[] = "tool_frame";

/// Kinova Gen3 at its home posture, the pose and posture gains of EC's null-space mode. The inertia
/// of the rotors is part of what is moved.
ComplianceLoop::Options Gen3(const NullSpaceComplianceOptions& o) {
  const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  const JointPosition home{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};
  ComplianceLoop::Options loop{
      .model = model,
      .tool = kTool,
      .arm = SimulatedGen3(
          model, {.position = home, .ideal = o.ideal, .seed = o.seed, .engine = o.engine}),
      .observer_gain = o.observer_gain,
      .damper = {.model = model}};
  if (!o.ideal) loop.low_level = LowLevelTorqueOf(loop.arm.actuators, model, loop.arm.period);
  loop.pushes = {{.model = model,
                  .link = "forearm_link",  // its origin is the elbow
                  .force = {0, o.push_N, 0},
                  .start_s = 0.5,
                  .duration_s = 1.5},
                 {.model = model,
                  .link = kTool,
                  .force = {0, 0, -o.push_N},
                  .start_s = 3.5,
                  .duration_s = 1.5}};
  return loop;
}

/// Springs between rotors and links ask for a method of higher order.
IntegratorOptions Integration(const NullSpaceComplianceOptions& o) {
  return {.method = o.ideal ? Method::kBogackiShampine : Method::kDormandPrince};
}

struct Setup {
  std::string title;
  double pose_compliance, posture_compliance;
  TorqueEstimate estimate;
};

/// What one run leaves: a column per millisecond.
struct Run {
  Setup setup;
  Eigen::VectorXd t = {};
  Series q = {}, v = {}, tau = {}, tau_e = {}, error = {}, error_rate = {};
  Series force = {};  // norms of the pushes
  int relaxed = 0, fallback = 0;
  Integrator::Statistics integrator = {};
  double wall_s = 0;
};

Series Columns(const Log& log, const std::string& value, const std::vector<std::string>& elements) {
  Series all(static_cast<Eigen::Index>(elements.size()), static_cast<Eigen::Index>(log.rows()));
  for (std::size_t i = 0; i < elements.size(); ++i)
    all.row(static_cast<Eigen::Index>(i)) = log[value + "[" + elements[i] + "]"];
  return all;
}

std::vector<std::string> Elements(const Joints& joints) {
  std::vector<std::string> names;
  for (int i = 0; i < joints.size(); ++i) names.push_back(joints[i]);
  return names;
}

Run Execute(const Setup& setup, const NullSpaceComplianceOptions& o, const Progress& progress) {
  ComplianceLoop::Options options = Gen3(o);
  options.pose_compliance = setup.pose_compliance;
  options.posture_compliance = setup.posture_compliance;
  options.estimate = setup.estimate;
  options.log_rows = static_cast<std::size_t>(o.duration_s * 1000) + 1;
  const ComplianceLoop loop(options);
  Simulator sim(loop.diagram, {.integrator = Integration(o)});

  const auto begin = std::chrono::steady_clock::now();
  const auto wall = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  const int parts = static_cast<int>(std::ceil(10 * o.duration_s));
  for (int k = 1; k <= parts; ++k) {
    sim.AdvanceTo(o.duration_s * k / parts);
    if (progress) progress(setup.title, sim.time(), o.duration_s, wall());
  }

  const Log& log = sim.Get(loop.logger->log);
  const std::vector<std::string> joints = Elements(options.model.joints());
  const std::vector<std::string> axes{"0", "1", "2", "3", "4", "5"};
  Run run{.setup = setup, .integrator = sim.statistics(), .wall_s = wall()};
  run.t = log.times();
  run.q = Columns(log, "arm.measured_position", joints);
  run.v = Columns(log, "arm.measured_velocity", joints);
  run.tau = Columns(log, "qp.torque", joints);
  run.tau_e = Columns(log, "true_torque.torque", joints);
  run.error = Columns(log, "pose.error", axes);
  run.error_rate = Columns(log, "pose.error_rate", axes);
  run.force.resize(static_cast<Eigen::Index>(options.pushes.size()), run.t.size());
  for (std::size_t i = 0; i < options.pushes.size(); ++i)
    run.force.row(static_cast<Eigen::Index>(i)) =
        Columns(log, "push_" + std::to_string(i + 1) + ".force.force", {"x", "y", "z"})
            .colwise()
            .norm();
  const Eigen::VectorXd outcome = log["qp.report.outcome"];
  run.relaxed = static_cast<int>((outcome.array() == 1).count());
  run.fallback = static_cast<int>((outcome.array() == 2).count());
  return run;
}

/// Largest norm of rows [first, first + rows) over time.
double Peak(const Series& all, int first, int rows) {
  return all.middleRows(first, rows).colwise().norm().maxCoeff();
}

double LargestTurn(const Run& run) {
  return (run.q.colwise() - run.q.col(0)).cwiseAbs().maxCoeff();
}

/// What the transfer function makes of the pushes of this run: e, 6 rows.
Series Predicted(const Run& run, const ComplianceLoop::Options& o) {
  const Series a =
      TaskAcceleration(o.model, o.tool, run.q, run.tau_e, o.arm.actuators.reflected_inertia());
  return DeviationBehindObserver(a, o.observer_gain, o.pose_damping, o.pose_stiffness,
                                 o.arm.period);
}

/// 1: the run used all of a limit; positions count from the middle of their range.
struct Use {
  double position = 0, velocity = 0, torque = 0;
  double most() const { return std::max({position, velocity, torque}); }
};

Use UseOfLimits(const Run& run, const RobotModel& model, int joint) {
  const Joint& j = model.joint(joint);
  Use use{.velocity = run.v.row(joint).cwiseAbs().maxCoeff() / j.velocity,
          .torque = run.tau.row(joint).cwiseAbs().maxCoeff() / j.effort};
  if (j.type != Joint::Type::Continuous) {
    const double middle = 0.5 * (j.lower + j.upper), half = 0.5 * (j.upper - j.lower);
    use.position = (run.q.row(joint).array() - middle).abs().maxCoeff() / half;
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
double StaticOffset(const ComplianceLoop::Options& o) {
  const LowLevelTorque::Options& loop = *o.low_level;
  const PerJoint missing = (loop.lag_gain * o.arm.sensors.torque_bias.cwiseAbs() +
                            PerJoint(loop.leak_limit) + 2 * loop.friction.stiction) /
                           (1 + loop.lag_gain);
  Eigen::Matrix<double, 6, 1> worst = Eigen::Matrix<double, 6, 1>::Zero();
  for (int j = 0; j < o.model.size(); ++j)
    worst += TaskAcceleration(o.model, o.tool, o.arm.position,
                              missing(j) * PerJoint::Unit(o.model.size(), j),
                              o.arm.actuators.reflected_inertia())
                 .cwiseAbs();
  return worst.tail<3>().norm() / o.pose_stiffness;
}

constexpr char kOffsetBasis[] =
    "the torque that friction, sensor offsets and the leak's clamp leave at rest, in all joints at "
    "once, against the pose's stiffness";

Claim StandsStill(const Run& run, const ComplianceLoop::Options& o) {
  const double turn = LargestTurn(run), shift = Peak(run.error, 3, 3);
  // Ideal: the states are at rest, so the integrator adds nothing; what its tolerance would allow
  // is the bound.
  const double bound = o.low_level ? StaticOffset(o) : IntegratorOptions{}.absolute_tolerance;
  return {
      .id = "stiff-true",
      .source = "EC (8), (9); IV-E 1",
      .paper = "Γ = 0 with the external torque known: neither the tool nor the joints move",
      .measured = "joints " + WithUnit(turn, "rad") + ", tool " + WithUnit(shift, "m"),
      .criterion = o.low_level
                       ? "tool below " + WithUnit(bound, "m") + "; the null space has no stiffness"
                       : "below " + WithUnit(bound, "rad") + " and " + WithUnit(bound, "m"),
      .basis = o.low_level
                   ? kOffsetBasis
                   : "the integrator's absolute tolerance; round-off alone leaves some 1e-15",
      .holds = shift < bound && (o.low_level || turn < bound)};
}

/// The tool of a run against 1.2 times the prediction for the pushes it got.
struct ToolBound {
  double shift, predicted_shift, turn, predicted_turn;
  bool holds() const { return shift < 1.2 * predicted_shift && turn < 1.2 * predicted_turn; }
  std::string measured() const {
    return "tool " + WithUnit(shift, "m") + " (predicted " + WithUnit(predicted_shift, "m") +
           "), " + WithUnit(turn, "rad") + " (predicted " + WithUnit(predicted_turn, "rad") + ")";
  }
};

ToolBound BoundTool(const Run& run, const ComplianceLoop::Options& o) {
  const Series predicted = Predicted(run, o);
  return {Peak(run.error, 3, 3), Peak(predicted, 3, 3), Peak(run.error, 0, 3),
          Peak(predicted, 0, 3)};
}

constexpr char kToolCriterion[] = "tool below 1.2 times the predicted peaks";

std::string ToolBasis(const ComplianceLoop::Options& o) {
  return "s/((s + " + Text(o.observer_gain) + ")(s² + " + Text(o.pose_damping) + " s + " +
         Text(o.pose_stiffness) +
         ")) applied to the recorded J M⁻¹ τ_e; 1.2 leaves room for J̇ and the posture's weight";
}

Claim HoldsTool(const Run& run, const ComplianceLoop::Options& o) {
  const ToolBound tool = BoundTool(run, o);
  return {.id = "stiff-observer",
          .source = "EC (9), (25); IV-E 1",
          .paper = "Γ = 0 with the momentum observer: no motion but what the observer is late by",
          .measured = tool.measured(),
          .criterion = kToolCriterion,
          .basis = ToolBasis(o),
          .holds = tool.holds()};
}

Claim YieldsInNullSpace(const Run& run, const ComplianceLoop::Options& o) {
  const ToolBound tool = BoundTool(run, o);
  const double turn = LargestTurn(run);
  return {
      .id = "null-space",
      .source = "EC (9); IV-E 2",
      .paper = "Γ₀ = I only: the joints follow the push while the tool stays",
      .measured = "joints " + Text(std::round(10 * turn * kDegrees) / 10) + "°; " + tool.measured(),
      .criterion = std::string("joints more than 5°; ") + kToolCriterion,
      .basis = "5°: well above what the stiff run moves; " + ToolBasis(o),
      .holds = turn * kDegrees > 5 && tool.holds()};
}

/// The sample at which the push at the tool has lasted longest at its full force.
Eigen::Index EndOfPlateau(const Run& run, const ComplianceLoop::Options& o) {
  const Push::Options& push = o.pushes.back();
  const double end = push.start_s + push.duration_s - push.edge_s;
  return std::ranges::lower_bound(run.t, end) - run.t.begin();
}

Claim YieldsEverywhere(const Run& run, const ComplianceLoop::Options& o) {
  const Eigen::Index k = EndOfPlateau(run, o);
  const Series static_error = TaskAcceleration(o.model, o.tool, run.q.col(k), run.tau_e.col(k),
                                               o.arm.actuators.reflected_inertia()) /
                              o.pose_stiffness;
  const Eigen::Vector3d e = run.error.col(k).tail(3), expected = static_error.col(0).tail(3);
  const double off = (e - expected).norm() / expected.norm();
  return {.id = "full",
          .source = "EC (9); IV-E 3",
          .paper = "all Γ = I: the tool gives way as a spring-damper with the arm's own inertia",
          .measured = "tool " + WithUnit(e.norm(), "m") + ", Λ⁻¹F/" + Text(o.pose_stiffness) +
                      " is " + WithUnit(expected.norm(), "m") + "; they differ by " +
                      Text(std::round(1000 * off) / 10) + " %",
          .criterion = "they differ by less than 10 %, as vectors",
          .basis = std::string(
              "EC (9) at rest, Λ at the measured q, at the end of the push's plateau: 22 time "
              "constants of s² + 40 s + 400 behind its rise; 10 % leaves room for the drift of "
              "the null space"),
          .holds = off < 0.1};
}

Claim KeepsLimits(const std::vector<Run>& runs, const RobotModel& model) {
  double most = 0;
  std::string where;
  int relaxed = 0, fallback = 0;
  for (const Run& run : runs) {
    relaxed += run.relaxed;
    fallback += run.fallback;
    for (int j = 0; j < model.size(); ++j) {
      const double use = UseOfLimits(run, model, j).most();
      if (use > most) most = use, where = model.joint(j).name + ", " + run.setup.title;
    }
  }
  return {.id = "limits",
          .source = "EC (10), (23), (24)",
          .paper = "no limit is crossed in any of the runs",
          .measured = "at most " + Text(std::round(1000 * most) / 10) + " % of a limit (" + where +
                      "); limits left out in " + Text(relaxed) + " ticks, fallback in " +
                      Text(fallback),
          .criterion = "below 100 % of every position, velocity and torque limit; none left out",
          .basis = "the limits of the robot's model",
          .holds = most < 1 && relaxed == 0 && fallback == 0};
}

std::vector<double> Vector(const Eigen::VectorXd& x) { return {x.begin(), x.end()}; }

std::vector<Band> PushBands(const ComplianceLoop::Options& o) {
  std::vector<Band> bands;
  for (const Push::Options& push : o.pushes)
    bands.push_back({push.start_s, push.start_s + push.duration_s});
  return bands;
}

/// The panels of EC-fig6: a column per compliance, the force in each.
Figure Velocities(const std::vector<const Run*>& runs, const ComplianceLoop::Options& o) {
  Figure figure{
      .name = "velocities",
      .caption =
          "Norms of the tool's linear and angular velocity and of the joint velocity, "
          "and (orange) the pushes: at the elbow, then at the tool. A column per compliance.",
      .columns = static_cast<int>(runs.size())};
  const auto add = [&](const Run& run, const std::string& title, const std::string& label,
                       const Eigen::VectorXd& norm, double top) {
    const std::vector<double> t = Vector(run.t);
    figure.panels.push_back(
        {.title = title,
         .x = {.label = "time [s]"},
         .left = {.label = label, .from = 0, .to = top},
         .right = {.label = "force [N]", .from = 0, .to = 1.25 * run.force.maxCoeff()},
         .curves = {{.label = "", .x = t, .y = Vector(norm)},
                    {.label = "",
                     .x = t,
                     .y = Vector(run.force.colwise().sum().transpose()),
                     .side = Side::Right}},
         .x_bands = PushBands(o)});
  };
  const auto norm = [](const Series& all, int first, int rows) {
    return Eigen::VectorXd(all.middleRows(first, rows).colwise().norm().transpose());
  };
  double linear = 0, angular = 0, joint = 0;  // one scale per row, so that columns compare
  for (const Run* run : runs) {
    linear = std::max(linear, 1.1 * norm(run->error_rate, 3, 3).maxCoeff());
    angular = std::max(angular, 1.1 * norm(run->error_rate, 0, 3).maxCoeff());
    joint = std::max(joint, 1.1 * norm(run->v, 0, o.model.size()).maxCoeff());
  }
  for (const Run* run : runs)
    add(*run, run->setup.title, "tool [m/s]", norm(run->error_rate, 3, 3), linear);
  for (const Run* run : runs) add(*run, "", "tool [rad/s]", norm(run->error_rate, 0, 3), angular);
  for (const Run* run : runs)
    add(*run, "", "joints [rad/s]", norm(run->v, 0, o.model.size()), joint);
  return figure;
}

/// Prediction and measurement of what the tool does together.
Figure Predictions(const Run& stiff, const Run& null_space, const Run& full,
                   const ComplianceLoop::Options& o) {
  Figure figure{.name = "predictions",
                .caption =
                    "How far the tool is off, measured and predicted: behind the observer by its "
                    "transfer function, with all Γ = I by Λ⁻¹F/" +
                    Text(o.pose_stiffness) + " as if the push were static."};
  const auto add = [&](const Run& run, const Series& predicted, const std::string& how) {
    const auto millimetres = [](const Series& e) {
      return Vector(1000 * e.middleRows(3, 3).colwise().norm().transpose());
    };
    figure.panels.push_back(
        {.title = run.setup.title,
         .x = {.label = "time [s]"},
         .left = {.label = "tool [mm]"},
         .curves = {{.label = "measured", .x = Vector(run.t), .y = millimetres(run.error)},
                    {.label = how, .x = Vector(run.t), .y = millimetres(predicted)}},
         .x_bands = PushBands(o)});
  };
  add(stiff, Predicted(stiff, o), "predicted");
  add(null_space, Predicted(null_space, o), "predicted");
  add(full,
      TaskAcceleration(o.model, o.tool, full.q, full.tau_e, o.arm.actuators.reflected_inertia()) /
          o.pose_stiffness,
      "if static");
  return figure;
}

/// Joint positions, velocities and torques of the run that moves most, as parts of their limits.
Figure Limits(const Run& run, const RobotModel& model) {
  Figure figure{.name = "limits",
                .caption = "Joint positions, velocities and torques as parts of their limits, " +
                           run.setup.title + ". Continuous joints have no position limit."};
  Panel position{.x = {.label = "time [s]"}, .left = {.label = "position / limit"}};
  Panel velocity{.x = {.label = "time [s]"}, .left = {.label = "velocity / limit"}};
  Panel torque{.x = {.label = "time [s]"}, .left = {.label = "torque / limit"}};
  const std::vector<double> t = Vector(run.t);
  for (int i = 0; i < model.size(); ++i) {
    const Joint& j = model.joint(i);
    if (j.type != Joint::Type::Continuous)
      position.curves.push_back({j.name, t,
                                 Vector((2 * run.q.row(i).array() - j.lower - j.upper).transpose() /
                                        (j.upper - j.lower))});
    velocity.curves.push_back({j.name, t, Vector(run.v.row(i).transpose() / j.velocity)});
    torque.curves.push_back({j.name, t, Vector(run.tau.row(i).transpose() / j.effort)});
  }
  for (Panel* panel : {&position, &velocity, &torque}) {
    panel->limits = {{1}, {-1}};
    panel->left.from = -1.1;
    panel->left.to = 1.1;
    figure.panels.push_back(std::move(*panel));
  }
  return figure;
}

std::vector<Setting> Settings(const ComplianceLoop::Options& o,
                              const NullSpaceComplianceOptions& n) {
  const IntegratorOptions integrator = Integration(n);
  std::string pushes;
  for (const Push::Options& push : o.pushes)
    pushes += (pushes.empty() ? "" : "; ") +
              ("(" + Text(push.force.transpose()) + ") N at " + push.link + " from " +
               Text(push.start_s) + " s for " + Text(push.duration_s) +
               " s, raised-cosine edges of " + Text(push.edge_s) + " s");
  return {
      {"robot",
       o.model.name() +
           (n.ideal ? ", ideal torque actuators and sensors, no friction; nothing is random"
                    : ", elastic gears with friction, sensors with noise and "
                      "offsets (seed " +
                          Text(n.seed) + "), RSS torque loop")},
      {"rotor inertia",
       Text(o.arm.actuators.reflected_inertia().transpose()) + " kg·m², reflected"},
      {"plant", n.engine == SimbodyPlant::Engine::Simbody ? "Simbody" : "recursive kernel"},
      {"controller", "one QP at " + o.arm.period.text() + ": pose of " + o.tool + " " +
                         Text(o.pose_stiffness) + "/" + Text(o.pose_damping) + ", weight " +
                         Text(o.pose_weight) + "; posture " + Text(o.posture_stiffness) + "/" +
                         Text(o.posture_damping) + ", weight " + Text(o.posture_weight)},
      {"limits", "torque, and dampers with λ = " + Text(o.damper.rate) +
                     " 1/s, M = " + Text(o.damper.damping_ratio) +
                     ", d_s = " + Text(100 * o.damper.safety_distance) + " % of the range"},
      {"estimator", "momentum observer, K_I = " + Text(o.observer_gain) + " 1/s"},
      {"pushes", pushes},
      {"integrator", std::string(Name(integrator.method)) + ", tolerances " +
                         Text(integrator.relative_tolerance) + " relative, " +
                         Text(integrator.absolute_tolerance) + " absolute"},
      {"duration", Text(n.duration_s) + " s for each of four runs"},
  };
}

Timing TimingOf(const std::vector<Run>& runs) {
  Timing timing{};
  for (const Run& run : runs) {
    timing.simulated_s += run.t(run.t.size() - 1) + 1e-3;
    timing.wall_s += run.wall_s;
    timing.ticks += run.t.size();
    timing.integrator_steps += run.integrator.steps;
    timing.derivative_calls += run.integrator.derivative_calls;
  }
  return timing;
}

/// Least and greatest of a quantity of every joint, over all runs.
std::vector<Extent> Extents(const std::vector<Run>& runs, const RobotModel& model, Series Run::*all,
                            double Joint::*lower, double Joint::*upper, double sign) {
  std::vector<Extent> extents;
  for (int j = 0; j < model.size(); ++j) {
    Extent e{model.joint(j).name, 1e300, -1e300, sign * (model.joint(j).*lower),
             model.joint(j).*upper};
    for (const Run& run : runs) {
      e.least = std::min(e.least, (run.*all).row(j).minCoeff());
      e.greatest = std::max(e.greatest, (run.*all).row(j).maxCoeff());
    }
    extents.push_back(e);
  }
  return extents;
}

}  // namespace

Report NullSpaceCompliance(const NullSpaceComplianceOptions& o, const Progress& progress) {
  Require(o.duration_s >= 5.2, "duration_s must be >= 5.2, when the last push has ended",
          o.duration_s);
  Require(o.push_N > 0, "push_N must be > 0", o.push_N);
  RequireGnuplot();
  const std::vector<Setup> setups{
      {"stiff, τ_e known", 0, 0, TorqueEstimate::True},
      {"stiff, Γ = 0", 0, 0, TorqueEstimate::Observer},
      {"null space, Γ₀ = I", 0, 1, TorqueEstimate::Observer},
      {"everywhere, all Γ = I", 1, 1, TorqueEstimate::Observer},
  };
  std::vector<Run> runs;
  for (const Setup& setup : setups) runs.push_back(Execute(setup, o, progress));
  const Run &known = runs[0], &stiff = runs[1], &null_space = runs[2], &full = runs[3];
  const ComplianceLoop::Options gen3 = Gen3(o);
  const RobotModel& model = gen3.model;

  Report report{
      .title = "Null-space compliance",
      .summary =
          "A Gen3 holds the pose of its tool and is pushed at the elbow and at the tool. One QP "
          "with the same gains makes it stiff, compliant in its null space only, or compliant "
          "everywhere, by the matrices Γ alone; what pushes is known through a momentum observer."};
  report.settings = Settings(gen3, o);
  report.claims = {StandsStill(known, gen3), HoldsTool(stiff, gen3),
                   YieldsInNullSpace(null_space, gen3), YieldsEverywhere(full, gen3),
                   KeepsLimits(runs, model)};
  report.figures = {Velocities({&stiff, &null_space, &full}, gen3),
                    Predictions(stiff, null_space, full, gen3), Limits(full, model)};
  report.tables = {
      ExtentsTable("Joint positions, all runs", "rad",
                   Extents(runs, model, &Run::q, &Joint::lower, &Joint::upper, 1)),
      ExtentsTable("Joint velocities, all runs", "rad/s",
                   Extents(runs, model, &Run::v, &Joint::velocity, &Joint::velocity, -1)),
      ExtentsTable("Joint torques, all runs", "N·m",
                   Extents(runs, model, &Run::tau, &Joint::effort, &Joint::effort, -1))};
  report.timing = TimingOf(runs);
  return report;
}

}  // namespace pliant
