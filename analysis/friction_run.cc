#include "pliant/analysis/friction_run.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <variant>

#include "pliant/analysis/signal_number.h"

namespace pliant {

namespace {

constexpr Eigen::Index kHalfWindow = 20;

/// A joint's rows from `begin` on, before `end`, all of one kind.
struct Stretch {
  Eigen::Index begin, end;
  Eigen::Index size() const { return end - begin; }
};

/// Where `is` holds without a gap.
template <class Is>
std::vector<Stretch> StretchesOf(Eigen::Index rows, const Is& is) {
  std::vector<Stretch> all;
  for (Eigen::Index k = 0; k < rows; ++k) {
    if (!is(k)) continue;
    if (all.empty() || all.back().end != k) all.push_back({k, k});
    all.back().end = k + 1;
  }
  return all;
}

/// The slope of v over t about row k, of rows in the stretch.
double SlopeAt(const Eigen::VectorXd& t, const Eigen::VectorXd& v, Eigen::Index k,
               const Stretch& in) {
  const Eigen::Index half = std::min({kHalfWindow, k - in.begin, in.end - 1 - k});
  if (half == 0) return 0;
  const Eigen::ArrayXd s = t.segment(k - half, 2 * half + 1).array() - t(k);
  return (s * v.segment(k - half, 2 * half + 1).array()).sum() / s.square().sum();
}

}  // namespace

void RequireFrictionExperiment(const Scenario& scenario) {
  Require(std::holds_alternative<FrictionExperiment::Options>(scenario.controller),
          "it is about a controller of the kind !FrictionExperiment");
  RequireEveryTick(scenario);
}

std::vector<TestedJoint> TestedJointsOf(const RunData& run) {
  const Eigen::VectorXd& t = run.times();
  const RecordedSignal& report = run.log["control.report"];
  const Eigen::VectorXd phase = report["phase"], under_test = report["joint"],
                        steady = report["steady"];
  const PerJoint kappa = run.arm.actuators.torque_per_ampere();
  const PerJoint B = run.arm.actuators.reflected_inertia();
  std::vector<TestedJoint> all;
  for (int j = 0; j < run.arm.model.size(); ++j) {
    const Eigen::VectorXd v = run["arm.measured_velocity"].row(j);
    const Eigen::VectorXd missing = kappa(j) * run["arm.measured_current"].row(j) -
                                    Eigen::RowVectorXd(run["arm.measured_torque"].row(j));
    const auto tested = [&](Eigen::Index k) { return under_test(k) == j; };
    const auto sliding =
        StretchesOf(t.size(), [&](Eigen::Index k) { return tested(k) && steady(k) != 0; });
    const auto ramps = StretchesOf(t.size(), [&](Eigen::Index k) {
      return tested(k) && phase(k) == static_cast<double>(FrictionPhase::BreakAway);
    });
    TestedJoint of{.joint = j, .samples = {}};
    Eigen::Index count = 0;
    for (const Stretch& stretch : sliding) count += stretch.size();
    if (count == 0) continue;
    of.samples.velocity.resize(count);
    of.samples.torque.resize(count);
    of.samples.begin.clear();
    Eigen::Index at = 0;
    for (const Stretch& stretch : sliding) {
      of.samples.begin.push_back(at);
      for (Eigen::Index k = stretch.begin; k < stretch.end; ++k, ++at) {
        of.samples.velocity(at) = v(k);
        of.samples.torque(at) = missing(k) - B(j) * SlopeAt(t, v, k, stretch);
      }
    }
    std::vector<double> broke;
    for (const Stretch& ramp : ramps) {
      // One that was stopped, or that the log ends in, broke nothing away.
      if (ramp.end == t.size() || phase(ramp.end) != static_cast<double>(FrictionPhase::Return))
        continue;
      const Stretch last{std::max(ramp.begin, ramp.end - 2 * kHalfWindow - 1), ramp.end};
      const Eigen::Index middle = (last.begin + last.end) / 2;
      broke.push_back(missing.segment(last.begin, last.size()).mean() -
                      B(j) * SlopeAt(t, v, middle, last));
      of.break_speed =
          std::max(of.break_speed, std::abs(v.segment(last.begin, last.size()).mean()));
    }
    of.samples.break_away = Eigen::Map<const Eigen::VectorXd>(broke.data(), std::ssize(broke));
    of.lasted_s =
        t(sliding.back().end - 1) - t(ramps.empty() ? sliding.front().begin : ramps.front().begin);
    all.push_back(std::move(of));
  }
  return all;
}

std::optional<RunData> FrictionRunOf(const std::filesystem::path& file) {
  if (file.extension() != ".mcap") return std::nullopt;
  try {
    if (RunHeading::Read(file).experiment.find(FrictionExperiment::Options::kTag) ==
        std::string::npos)
      return std::nullopt;
  } catch (const Error&) {  // somebody else's
    return std::nullopt;
  }
  RunData run = RunData::Read(file);
  if (!std::holds_alternative<FrictionExperiment::Options>(run.scenario.controller))
    return std::nullopt;
  RequireFrictionExperiment(run.scenario);
  return run;
}

std::vector<TestedDrive> TestedDrivesOf(const RunData& run) {
  std::vector<TestedDrive> all;
  for (TestedJoint& joint : TestedJointsOf(run)) {
    const ActuatorParameters& p = run.arm.actuators.joint[static_cast<std::size_t>(joint.joint)];
    all.push_back({.log = {.joint = run.arm.model.joint(joint.joint).name,
                           .samples = std::move(joint.samples)},
                   .drive = {p.torque_per_ampere(), p.reflected_inertia()}});
  }
  return all;
}

std::vector<ActuatorSize> SizesOf(const RunData& run) {
  const auto kind = [&](int joint) {
    ActuatorParameters p = run.arm.actuators.joint[static_cast<std::size_t>(joint)];
    p.friction = {};
    return std::tuple(p.gear_ratio, p.torque_constant, p.rotor_inertia);
  };
  std::vector<ActuatorSize> sizes;
  for (TestedJoint& joint : TestedJointsOf(run)) {
    const auto found = std::ranges::find_if(sizes, [&](const ActuatorSize& size) {
      return kind(size.joints.front().joint) == kind(joint.joint);
    });
    ActuatorSize& size = found == sizes.end() ? sizes.emplace_back() : *found;
    size.name += (size.name.empty() ? "" : ", ") + run.arm.model.joint(joint.joint).name;
    size.joints.push_back(std::move(joint));
  }
  return sizes;
}

SizeFit FitOf(const ActuatorSize& size) {
  SizeFit fit;
  std::vector<FrictionSamples> samples;
  for (const TestedJoint& joint : size.joints) {
    samples.push_back(joint.samples);
    fit.each.push_back(FitFriction(joint.samples, {.offset = true, .folds = 0}));
  }
  fit.pooled = Pooled(samples, fit.each);
  fit.all = FitFriction(fit.pooled, {.folds = 0});
  return fit;
}

}  // namespace pliant
