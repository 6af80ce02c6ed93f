#include "pliant/analysis/damper_claim.h"

#include <algorithm>

#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

constexpr const char* kPosition = "arm.position";
constexpr const char* kVelocity = "arm.velocity";

}  // namespace

void DamperClaim::RequireFit(const Scenario& scenario) const {
  RequireRowBetween(from_s, kUnbounded, scenario);
}

void DamperClaim::RequireSound(const Recording& recorded) const { recorded[kPosition].row(joint); }

Claim DamperClaim::Check(const Runs& all) const {
  std::string measured;
  bool holds = true;
  for (const std::string& name : runs) {
    const RunData& run = all[name];
    const Joint& j = run.arm.model.joint(run.arm.model.joint_index(joint));
    const JointDamper::Options& damper = run.control.damper;
    const RowsBetween rows(run.times(), from_s, kUnbounded);
    const auto of = [&](const char* path) {
      const RecordedSignal& signal = run.log[path];
      return Eigen::VectorXd(
          signal.numbers.row(signal.row(joint)).segment(rows.begin, rows.size()).transpose());
    };
    const double over_speed =
        of(kVelocity).cwiseAbs().maxCoeff() - damper.velocity_fraction * j.velocity;
    const auto says = [&](double over, const char* unit) {
      return WithUnit(std::abs(over), unit) + (over > 0 ? " beyond" : " before");
    };
    measured +=
        (measured.empty() ? "" : "; ") + run.title + ": " + says(over_speed, "rad/s") + " q̇⁺";
    bool any = over_speed > 0, both = any;
    if (j.type != Joint::Type::Continuous) {
      const double d_s = damper.safety_distance * (j.upper - j.lower);
      const double beyond = std::max(of(kPosition).maxCoeff() - (j.upper - d_s),
                                     j.lower + d_s - of(kPosition).minCoeff());
      measured += ", " + says(beyond, "rad") + " the d_s line";
      any = any || beyond > 0;
      both = both && beyond > 0;
    }
    holds = holds && (crossed ? both : !any);
  }
  return claim.Stated(measured,
                      crossed ? "each of the runs passes q̇⁺ and the d_s line"
                              : "none of the runs passes q̇⁺ or the d_s line",
                      "the bounds of the damper themselves, of true positions and velocities",
                      holds);
}

}  // namespace pliant
