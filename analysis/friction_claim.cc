#include "pliant/analysis/friction_claim.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/analysis/friction_run.h"

namespace pliant {

namespace {

/// What one term is called, where the truth is, and in what it is measured.
struct Term {
  const char* name;
  const char* unit;
  double FrictionParameters::*truth;
};

const Term& TermOf(FrictionTerm term) {
  static const std::array<Term, 3> terms{{{"coulomb", "N·m", &FrictionParameters::coulomb},
                                          {"viscous", "N·m·s/rad", &FrictionParameters::viscous},
                                          {"stiction", "N·m", &FrictionParameters::stiction}}};
  return terms[static_cast<std::size_t>(term)];
}

std::string Rounded(double x) { return Text(std::round(1e4 * x) / 1e4); }

/// A fit of some joints against their truth.
class Comparison {
 public:
  Comparison(const RunData& run, FrictionTerm term, double within)
      : run_{run}, term_{term}, within_{within} {}

  void Add(const std::string& name, const FrictionFit& fit,
           const std::vector<TestedJoint>& joints) {
    const Term& term = TermOf(term_);
    const FrictionEstimate* found = fit.Find(term.name);
    measured_ += (measured_.empty() ? "" : "; ") + name + " ";
    if (!found) {
      measured_ += "not identified";
      holds_ = false;
      return;
    }
    const FrictionParameters& friction =
        run_.arm.actuators.joint[static_cast<std::size_t>(joints.front().joint)].friction;
    const double truth = friction.*term.truth, off = std::abs(found->value - truth);
    double drift = 0, fastest = 0, broke = 0;
    for (const TestedJoint& joint : joints) {
      drift = std::max(drift, DriftOf(joint));
      fastest = std::max(fastest, joint.samples.velocity.cwiseAbs().maxCoeff());
      broke = std::max(broke, joint.break_speed);
    }
    const double interval = std::max(found->high - found->value, found->value - found->low);
    const double allowed = interval + (term_ == FrictionTerm::Viscous ? drift / fastest : drift) +
                           (term_ == FrictionTerm::Static ? friction.viscous * broke : 0);
    measured_ += Rounded(found->value) + " for " + Text(truth) + " (" + Rounded(off) +
                 " off, allowed " + Rounded(allowed) + ", half the interval " + Rounded(interval) +
                 ")";
    // NaN never holds.
    holds_ = holds_ && off <= allowed && interval <= within_ * truth;
    covered_ += off <= interval;
    ++all_;
  }
  /// Joints of which there is no fit, and why.
  void Lacks(const std::string& name, const std::string& why) {
    measured_ += (measured_.empty() ? "" : "; ") + name + " " + why;
    holds_ = false;
  }
  std::string measured() const {
    return measured_ + " " + TermOf(term_).unit + "; " + Text(covered_) + " of " + Text(all_) +
           " intervals hold the truth";
  }
  bool holds() const { return holds_ && all_ > 0; }

 private:
  double DriftOf(const TestedJoint& joint) const {
    const JointSensors::Options& sensors = run_.arm.sensors;
    if (sensors.torque_drift.size() == 0) return 0;
    return 3 * sensors.torque_drift(joint.joint) *
           std::sqrt(2 * (1 - std::exp(-joint.lasted_s / sensors.torque_drift_time_s)));
  }

  const RunData& run_;
  const FrictionTerm term_;
  const double within_;
  std::string measured_;
  bool holds_ = true;
  int covered_ = 0, all_ = 0;
};

std::vector<std::string> JointsToTest(const RunData& run) {
  std::vector<std::string> joints = std::get<FrictionExperiment::Options>(run.control).test.joints;
  if (joints.empty())
    for (int j = 0; j < run.arm.model.size(); ++j) joints.push_back(run.arm.model.joint(j).name);
  return joints;
}

}  // namespace

void FrictionIdentified::RequireFit(const Scenario& scenario) const {
  RequireFrictionExperiment(scenario);
  Require(!IsIdeal(scenario), "station.ideal must be false: ideal actuators have no friction");
}

Claim FrictionIdentified::Check(const Runs& runs) const {
  const RunData& tested = runs[run];
  Comparison comparison(tested, term, within);
  std::vector<std::string> shown;
  for (const ActuatorSize& size : SizesOf(tested)) {
    for (const TestedJoint& joint : size.joints)
      shown.push_back(tested.arm.model.joint(joint.joint).name);
    try {
      const SizeFit fit = FitOf(size);
      if (of == FrictionGroup::Sizes) comparison.Add(size.name, fit.all, size.joints);
      for (std::size_t i = 0; of == FrictionGroup::Joints && i < fit.each.size(); ++i)
        comparison.Add(tested.arm.model.joint(size.joints[i].joint).name, fit.each[i],
                       {size.joints[i]});
    } catch (const Error& e) {  // too little of a test that was stopped
      comparison.Lacks(size.name, e.what());
    }
  }
  for (const std::string& name : JointsToTest(tested))
    if (std::ranges::find(shown, name) == shown.end()) comparison.Lacks(name, "was not tested");
  const std::string of_whom = of == FrictionGroup::Sizes ? "each actuator size" : "each joint";
  return claim.Stated(
      comparison.measured(),
      "of " + of_whom + " half the 95 % interval at most " + Text(100 * within) +
          " % of the truth, and off by at most that half and what the torque sensor drifts" +
          (term == FrictionTerm::Viscous ? " over the largest speed" : "") +
          (term == FrictionTerm::Static ? " and viscous friction adds when breaking away is noticed"
                                        : ""),
      "the interval takes the sensor's offset for constant; its drift within the test of a joint, "
      "3 σ_d √(2 (1 − exp(−t/T))), is that of the simulated sensor",
      comparison.holds());
}

}  // namespace pliant
