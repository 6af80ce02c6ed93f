#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

#include "pliant/diagrams/contact_place.h"
#include "pliant/diagrams/seen_contacts.h"
#include "pliant/estimators/contact_force_estimate.h"

namespace pliant {

/// Where the arm is touched is known, as a simulation knows it.
struct KnownContacts {
  static constexpr const char* kTag = "Known";

  template <class F>
  void Parameters(F&&) {}
};

/// What says where the arm is touched.
using ContactPlaces = std::variant<KnownContacts, SeenContacts>;

/// How contacts are found, and what is to happen at them.
struct ContactSettings {
  ContactBehavior behavior = {};
  ContactPlaces localization = {};
  double tare_from_s = 0.5;  ///< of the offset that is taken off, as ResidualTare has it
  double tare_until_s = 1.5;
  JointMatrix threshold = JointMatrix::Constant(1, 1, 2);  ///< c [N·m], a number or one per joint
  double release = 0.5;                                    ///< ρ, as ContactDetection has it
  double smallest_lever = 0.05;                            ///< σ₀ [m]
  double same_point = 0.05;                                ///< as ContactAnchor has it [m]

  template <class F>
  void Parameters(F&& f) {
    f("behavior", behavior);
    f("localization", localization);
    f("tare_from_s", tare_from_s, "s", kNotNegative);
    f("tare_until_s", tare_until_s, "s", kNotNegative);
    f("threshold", threshold, "N·m", kPositive);
    f("release", release, "", Between(0, 1));
    f("smallest_lever", smallest_lever, "m", kPositive);
    f("same_point", same_point, "m", kNotNegative);
  }
};

/// Finds contacts wherever an arm is touched, and says what is to happen there, as terms for what
/// solves for the joint accelerations: ContactLaw, or a ComplianceQp with all its limits.
///
///   residual ─▶ tare ─▶ detection ─▶ estimate ─▶ place 1, 2, 3 ─▶ objectives
///   forces ─▶ true contacts, or image ─▶ localization ─▶ estimate
///
/// The residual is that of an observer driven by joint torques. The arm has to rest untouched while
/// the residual's offset is taken.
class ContactTasks final : public Composite {
 public:
  struct Options {
    RobotModel model;  ///< the controller's
    Duration period;
    ContactSettings settings = {};
    double weight = 1;  ///< of the objectives
  };

  explicit ContactTasks(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<JointTorque> raw_residual;  ///< r, with its offset
  InputList<ContactForce> forces;   ///< of the environment
  /// Of the camera, if contacts are seen.
  std::optional<Input<DepthImage>> image;
  Output<JointTorque> residual;  ///< less its offset
  Output<bool> touched;
  Output<int> link;                     ///< the innermost the residual allows; −1: not touched
  Output<JointTorque> external_torque;  ///< Σ J_cᵀ F̂
  Output<Contacts> contacts;            ///< with F̂, where it was found
  Output<Contacts> acting;              ///< with F̂, at the points that the objectives are about
  Output<ContactObservability> observability;
  Output<ContactSight> sight;  ///< nothing is seen of known contacts
  Output<double> place_error;  ///< as PlaceError has it; 0 of known contacts [m]

  std::array<Output<Objective>, kMaxContacts> objectives;

  /// For each of the places: how far it is from where contact began and so on.
  std::array<const ContactPlace*, kMaxContacts> places{};
};

}  // namespace pliant
