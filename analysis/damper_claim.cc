#include "pliant/analysis/damper_claim.h"

#include <algorithm>

#include "pliant/analysis/series.h"
#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr const char* kPosition = "arm.position";
constexpr const char* kVelocity = "arm.velocity";

}  // namespace

void DamperClaim::RequireFit(const Scenario& scenario) const {
  ComplianceOf(scenario.controller);
  RequireRowBetween(from_s, to_s, scenario);
  const RobotModel model = RobotOf(scenario);
  Require(bound != DamperBound::Position ||
              model.joint(model.joint_index(joint)).type != Joint::Type::Continuous,
          "bound position: '" + joint + "' is continuous and has no position limit");
}

void DamperClaim::RequireSound(const Recording& recorded) const { recorded[kPosition].row(joint); }

Claim DamperClaim::Check(const Runs& all) const {
  std::string measured;
  bool holds = true;
  for (const std::string& name : runs) {
    const RunData& run = all[name];
    const Joint& j = run.arm.model.joint(run.arm.model.joint_index(joint));
    const JointDamper::Options& damper = ComplianceOf(run.control).damper;
    const RowsBetween rows(run.times(), from_s, to_s);
    const auto of = [&](const char* path) {
      const RecordedSignal& signal = run.log[path];
      return Eigen::VectorXd(
          signal.numbers.row(signal.row(joint)).segment(rows.begin, rows.size()).transpose());
    };
    const auto is = [&](double beyond, const char* unit, const char* limit) {
      measured += (measured.ends_with(' ') ? "" : ", ") + WithUnit(std::abs(beyond), unit) +
                  (beyond > 0 ? " beyond " : " before ") + limit;
      holds = holds && (crossed ? beyond > 0 : beyond <= 0);  // NaN never holds
    };
    measured += (measured.empty() ? "" : "; ") + run.title + ": ";
    if (bound != DamperBound::Position)
      is(Largest(of(kVelocity).cwiseAbs()) - damper.velocity_fraction * j.velocity, "rad/s", "q̇⁺");
    if (bound != DamperBound::Speed && j.type != Joint::Type::Continuous) {
      const double d_s = damper.safety_distance * (j.upper - j.lower);
      is(Largest(
             (of(kPosition).array() - (j.upper - d_s)).max(j.lower + d_s - of(kPosition).array())),
         "rad", "the d_s line");
    }
  }
  const std::string which = bound == DamperBound::Position ? "the d_s line"
                            : bound == DamperBound::Speed  ? "q̇⁺"
                                                           : "q̇⁺ or the d_s line";
  return claim.Stated(
      measured,
      crossed ? "each of the runs passes all that is named" : "none of the runs passes " + which,
      "the bounds of the damper themselves, of true positions and velocities", holds);
}

}  // namespace pliant
