#include "pliant/analysis/contact_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/analysis/series.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

struct Row {
  const char* word;
  const char* region;
  double pressure;  // [N/cm²]
  double force;     // [N]
};

// ISO/TS 15066:2016, table A.2.
constexpr std::array<Row, 29> kTable{{
    {"middle_of_forehead", "skull and forehead", 130, 130},
    {"temple", "skull and forehead", 110, 130},
    {"masticatory_muscle", "face", 110, 65},
    {"neck_muscle", "neck", 140, 150},
    {"seventh_neck_vertebra", "neck", 210, 150},
    {"shoulder_joint", "back and shoulders", 160, 210},
    {"fifth_lumbar_vertebra", "back and shoulders", 210, 210},
    {"sternum", "chest", 120, 140},
    {"pectoral_muscle", "chest", 170, 140},
    {"abdominal_muscle", "abdomen", 140, 110},
    {"pelvic_bone", "pelvis", 210, 180},
    {"deltoid_muscle", "upper arms and elbow joints", 190, 150},
    {"humerus", "upper arms and elbow joints", 220, 150},
    {"radial_bone", "lower arms and wrist joints", 190, 160},
    {"forearm_muscle", "lower arms and wrist joints", 180, 160},
    {"arm_nerve", "lower arms and wrist joints", 180, 160},
    {"forefinger_pad_d", "hands and fingers", 300, 140},
    {"forefinger_pad_nd", "hands and fingers", 270, 140},
    {"forefinger_end_joint_d", "hands and fingers", 280, 140},
    {"forefinger_end_joint_nd", "hands and fingers", 220, 140},
    {"thenar_eminence", "hands and fingers", 200, 140},
    {"palm_d", "hands and fingers", 260, 140},
    {"palm_nd", "hands and fingers", 260, 140},
    {"back_of_hand_d", "hands and fingers", 200, 140},
    {"back_of_hand_nd", "hands and fingers", 190, 140},
    {"thigh_muscle", "thighs and knees", 250, 220},
    {"kneecap", "thighs and knees", 220, 220},
    {"middle_of_shin", "lower legs", 220, 130},
    {"calf_muscle", "lower legs", 210, 130},
}};

constexpr double kTransient_s = 0.5, kPause_s = 0.1;

/// "12 N of 140 N"
std::string Against(double value, double limit, const char* unit) {
  return limit > 0 ? WithUnit(value, unit) + " of " + WithUnit(limit, unit)
                   : WithUnit(value, unit) + ", where none is permitted";
}

}  // namespace

const std::vector<std::string>& Words(BodyArea) {
  static const std::vector<std::string> words = [] {
    std::vector<std::string> all;
    for (const Row& row : kTable) all.emplace_back(row.word);
    return all;
  }();
  return words;
}

ContactLimits LimitsOf(BodyArea area) {
  const Row& row = kTable[static_cast<std::size_t>(area)];
  const bool head = area <= BodyArea::MasticatoryMuscle;
  return {.region = row.region,
          .force = row.force,
          .pressure = 1e4 * row.pressure,
          .transient = head ? 0.0 : 2.0};
}

ContactSummary ContactsOf(const Eigen::VectorXd& times, const Eigen::VectorXd& force,
                          double threshold) {
  ContactSummary all;
  double began = 0, last = -kUnbounded;
  for (Eigen::Index k = 0; k < times.size(); ++k) {
    const double f = std::isnan(force(k)) ? kUnbounded : force(k);
    if (f < threshold) continue;
    if (times(k) - last > kPause_s) {
      began = times(k);
      ++all.count;
    }
    last = times(k);
    const double lasted = times(k) - began;
    all.longest_s = std::max(all.longest_s, lasted);
    double& largest = lasted < kTransient_s ? all.transient : all.quasi_static;
    largest = std::max(largest, f);
  }
  return all;
}

std::array<Eigen::Index, 3> ForceRows(const RecordedSignal& contact) {
  for (const std::array<const char*, 3>& names :
       {std::array{"force[x]", "force[y]", "force[z]"}, std::array{"fx", "fy", "fz"}}) {
    const auto has = [&](const char* name) {
      return std::ranges::any_of(contact.elements, [&](const std::string& element) {
        return element.find(name) != std::string::npos;
      });
    };
    if (!std::ranges::all_of(names, has)) continue;
    return {contact.row(names[0]), contact.row(names[1]), contact.row(names[2])};
  }
  throw Error(contact.path +
              " has no force: expected a contact or a wrench, with elements "
              "force[x], … or fx, …; it is a " +
              contact.type);
}

void KeepsContactLimits::RequireSound(const Recording& recorded) const {
  ForceRows(recorded[contact]);
}

Claim KeepsContactLimits::Judge(const RecordedSignal& recorded) const {
  const ContactSummary of = ContactsOf(
      recorded.times, Norms(recorded.numbers(ForceRows(recorded), Eigen::all)), threshold);
  const ContactLimits limits = LimitsOf(body);
  std::string measured =
      std::to_string(of.count) + (of.count == 1 ? " contact" : " contacts") + " of " + contact;
  bool holds = of.count > 0;
  const auto compare = [&](const char* kind, double force, double multiple) {
    if (force == 0) return;
    measured += std::string("; ") + kind + " " + Against(force, multiple * limits.force, "N");
    holds = holds && force <= multiple * limits.force;
    if (area == 0) return;
    measured += ", " + Against(1e-4 * force / area, 1e-4 * multiple * limits.pressure, "N/cm²");
    holds = holds && force / area <= multiple * limits.pressure;
  };
  compare("transient", of.transient, limits.transient);
  compare("quasi-static", of.quasi_static, 1);
  const std::string word = kTable[static_cast<std::size_t>(body)].word;
  return claim.Stated(measured, "within the limits of " + word + " (" + limits.region + ")",
                      "ISO/TS 15066:2016, table A.2; transient: the first half second" +
                          std::string(area > 0 ? "" : "; pressures are not known"),
                      holds);
}

}  // namespace pliant
