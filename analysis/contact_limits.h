#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pliant/analysis/claim_source.h"
#include "pliant/analysis/run_data.h"

namespace pliant {

/// The part of a person that is touched. Of the hand, _d is the dominant one.
enum class BodyArea {
  MiddleOfForehead,
  Temple,
  MasticatoryMuscle,
  NeckMuscle,
  SeventhNeckVertebra,
  ShoulderJoint,
  FifthLumbarVertebra,
  Sternum,
  PectoralMuscle,
  AbdominalMuscle,
  PelvicBone,
  DeltoidMuscle,
  Humerus,
  RadialBone,
  ForearmMuscle,
  ArmNerve,
  ForefingerPadD,
  ForefingerPadNd,
  ForefingerEndJointD,
  ForefingerEndJointNd,
  ThenarEminence,
  PalmD,
  PalmNd,
  BackOfHandD,
  BackOfHandNd,
  ThighMuscle,
  Kneecap,
  MiddleOfShin,
  CalfMuscle
};

/// middle_of_forehead, temple, …, calf_muscle.
const std::vector<std::string>& Words(BodyArea);

/// What a contact with a part of the body may come to.
/// Source: ISO/TS 15066:2016, table A.2. Its limits of force are from a study of literature, at
/// which bruises begin; those of pressure, at which pain begins, from a study of 100 adults.
struct ContactLimits {
  std::string region;    ///< of the body, such as "hands and fingers"
  double force;          ///< [N], quasi-static
  double pressure;       ///< [Pa], quasi-static
  double transient = 2;  ///< of both for a transient contact, as a multiple; 0: none is permitted
};
ContactLimits LimitsOf(BodyArea area);

/// The contacts in a log and the largest forces in them. A contact lasts while ‖F‖ ≥ `threshold`,
/// with pauses of 0.1 s at most: a part that is tapped has no time to recover between.
/// Its first half second is transient, what follows quasi-static: the part of the body is clamped,
/// or moves along.
struct ContactSummary {
  int count = 0;
  double transient = 0;     ///< largest ‖F‖ of the first halves of a second [N]
  double quasi_static = 0;  ///< largest ‖F‖ afterwards [N]
  double longest_s = 0;
};

/// Of ‖F‖ [N], one for each of `times`. What is not a number is infinite.
ContactSummary ContactsOf(const Eigen::VectorXd& times, const Eigen::VectorXd& force,
                          double threshold);

/// The rows with the force of a recorded contact or wrench: of the elements force[x], … or fx, …;
/// throws Error if it has neither.
std::array<Eigen::Index, 3> ForceRows(const RecordedSignal& contact);

/// Contacts stay within what a person bears: forces, and mean pressures F/A if the area A of the
/// contact is known, transient and quasi-static. Where nothing was touched there is nothing to
/// hold.
struct KeepsContactLimits {
  static constexpr const char* kTag = "KeepsContactLimits";
  ClaimSource claim;
  std::string run;
  std::string contact;               ///< signal, such as hand_1.contact
  BodyArea body = BodyArea::PalmNd;  ///< that is touched
  double area = 0;                   ///< A [m²]; 0: not known, then only forces are compared
  double threshold = 1;              ///< [N]

  template <class F>
  void Parameters(F&& f) {
    claim.Parameters(f);
    f("run", run);
    f("contact", contact);
    f("body", body);
    f("area", area, "m²", kNotNegative);
    f("threshold", threshold, "N", kPositive);
  }
  /// Throws Error if the signal is not there, or has no force.
  void RequireSound(const Recording& recorded) const;
  /// Of one recorded signal, of whatever log.
  Claim Judge(const RecordedSignal& recorded) const;
  Claim Check(const Runs& runs) const { return Judge(runs[run].log[contact]); }
};

}  // namespace pliant
