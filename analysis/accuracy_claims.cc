#include "pliant/analysis/accuracy_claims.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr const char* kTool = "tool.pose";
constexpr const char* kTarget = "control.target";

Series PositionsOf(const RecordedSignal& pose) {
  const std::array<Eigen::Index, 3> rows{pose.row("position[x]"), pose.row("position[y]"),
                                         pose.row("position[z]")};
  return pose.numbers(rows, Eigen::all);
}

/// The pose in the row of a time, or in the first after it.
Pose PoseAt(const RecordedSignal& pose, double t) {
  const Eigen::Index k =
      std::min<Eigen::Index>((pose.times.array() < t - 1e-9).count(), pose.times.size() - 1);
  Pose at;
  constexpr std::array<const char*, 3> axes{"position[x]", "position[y]", "position[z]"};
  for (int i = 0; i < 3; ++i) at.position(i) = pose.numbers(pose.row(axes[i]), k);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      at.rotation(i, j) = pose.numbers(
          pose.row("rotation[" + std::to_string(i) + "," + std::to_string(j) + "]"), k);
  return at;
}

PathAccuracy Followed(const RunData& run, const Rounds& rounds) {
  return PathAccuracyOf(run.log[kTool].times, PositionsOf(run.log[kTarget]),
                        PositionsOf(run.log[kTool]), rounds);
}

PoseAccuracy Reached(const RunData& run, const ComesAsNear& asked) {
  std::vector<Pose> attained;
  const Pose commanded = PoseAt(run.log[kTarget], asked.from_s);
  for (int i = 0; i < asked.visits; ++i) {
    const double t = asked.from_s + i * asked.every_s;
    const Pose target = PoseAt(run.log[kTarget], t);
    Require((target.position - commanded.position).norm() < 1e-9 &&
                (target.rotation - commanded.rotation).norm() < 1e-9,
            "all visits are to be of one commanded pose; run '" + run.name +
                "' commands another one at " + Text(t) + " s than at " + Text(asked.from_s) + " s");
    attained.push_back(PoseAt(run.log[kTool], t));
  }
  return PoseAccuracyOf(attained, commanded);
}

/// "AT 1.2 mm, RT 0.3 mm"
std::string Both(const char* first, double accuracy, const char* second, double repeatability) {
  return std::string(first) + " " + WithUnit(accuracy, "m") + ", " + second + " " +
         WithUnit(repeatability, "m");
}

template <class Asked>
void RequireUntil(const Asked& asked, double end_s, const Scenario& scenario, const char* what) {
  Require(asked.run != asked.to, "a run cannot be compared with itself, '" + asked.run + "'");
  Require(end_s <= scenario.duration_s + 1e-9,
          std::string(what) + " must lie within duration_s, " + Text(scenario.duration_s), end_s);
}

void RequirePoses(const Recording& recorded) {
  for (const char* path : {kTool, kTarget}) recorded[path];
}

}  // namespace

void FollowsAsWell::RequireFit(const Scenario& scenario) const {
  RequireUntil(*this, from_s + rounds * period_s, scenario, "the end of the last round");
}

void FollowsAsWell::RequireSound(const Recording& recorded) const { RequirePoses(recorded); }

Claim FollowsAsWell::Check(const Runs& runs) const {
  const Rounds all{.from_s = from_s, .period_s = period_s, .count = rounds};
  const PathAccuracy of = Followed(runs[run], all), other = Followed(runs[to], all);
  return claim.Stated(
      Both("AT", of.accuracy, "RT", of.repeatability) + "; " + to + " " +
          Both("AT", other.accuracy, "RT", other.repeatability),
      "AT and RT at most " + WithUnit(margin, "m") + " above those of " + to, basis,
      of.accuracy <= other.accuracy + margin && of.repeatability <= other.repeatability + margin);
}

void ComesAsNear::RequireFit(const Scenario& scenario) const {
  RequireUntil(*this, from_s + (visits - 1) * every_s, scenario, "the last visit");
}

void ComesAsNear::RequireSound(const Recording& recorded) const { RequirePoses(recorded); }

Claim ComesAsNear::Check(const Runs& runs) const {
  const PoseAccuracy of = Reached(runs[run], *this), other = Reached(runs[to], *this);
  const auto turned = [](const PoseAccuracy& a) {
    return " (orientation " + WithUnit(a.rotation.maxCoeff(), "rad") + ", " +
           WithUnit(a.rotation_repeatability.maxCoeff(), "rad") + ")";
  };
  return claim.Stated(
      Both("AP", of.position, "RP", of.position_repeatability) + turned(of) + "; " + to + " " +
          Both("AP", other.position, "RP", other.position_repeatability) + turned(other),
      "AP and RP at most " + WithUnit(margin, "m") + " above those of " + to, basis,
      of.position <= other.position + margin &&
          of.position_repeatability <= other.position_repeatability + margin);
}

}  // namespace pliant
