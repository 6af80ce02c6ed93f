#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

#include "pliant/controllers/contact_law.h"
#include "pliant/diagrams/contact_place.h"
#include "pliant/diagrams/torque_actuation.h"
#include "pliant/estimators/contact_force_estimate.h"
#include "pliant/estimators/residual_tare.h"

namespace pliant {

/// Where the arm is touched is known, as a simulation knows it.
struct KnownContacts {
  static constexpr const char* kTag = "Known";

  template <class F>
  void Parameters(F&&) {}
};

/// What says where the arm is touched.
using ContactPlaces = std::variant<KnownContacts>;

/// Controls motion or force wherever an arm is touched, without a sensor of force.
///
///   measured_… ─▶ dynamics ─▶ observer ─▶ tare ─▶ detection ─▶ estimate ─▶ place 1, 2, 3 ─▶ law
///   contacts ─▶ true contacts ─▶ (localization) ─▶ estimate
///   law ─▶ actuation ─▶ current;  law ─▶ torque
///
/// The observer is driven by joint torques, and needs the arm to rest untouched while its offset is
/// taken. Until a contact has begun the arm holds its posture.
///
/// The rotors are part of what the controller moves, and so of the natural inertia of a contact;
/// the observer, which is driven by torque sensors behind the gears, takes them off again.
/// Source: Magrini, Flacco & De Luca 2015 (CF).
class ContactControl final : public Composite {
 public:
  struct Options {
    static constexpr const char* kTag = "ContactControl";

    RobotModel model;        ///< the controller's
    JointPosition position;  ///< at the start
    PerJoint rotor_inertia;  ///< B, reflected [kg·m²]; empty: none
    Duration period = 1ms;   ///< of the arm's interface
    /// The motors that `torque_loop` makes currents for; its gains replace theirs. Without,
    /// `current` stays zero.
    std::optional<LowLevelTorque::Options> low_level = {};

    std::string tool;  ///< link whose motion is of interest
    ContactBehavior behavior = {};
    ContactLaw::Settings rest = {};  ///< of what contacts leave free
    ContactPlaces localization = {};
    double observer_gain = 50;  ///< K_I [1/s]
    double tare_from_s = 0.5;   ///< of the offset that is taken off, as ResidualTare has it
    double tare_until_s = 1.5;
    JointMatrix threshold = JointMatrix::Constant(1, 1, 2);  ///< c [N·m], a number or one per joint
    double release = 0.5;                                    ///< ρ, as ContactDetection has it
    double smallest_lever = 0.05;                            ///< σ₀ [m]
    double same_point = 0.05;                                ///< as ContactAnchor has it [m]
    TorqueLoopChoice torque_loop = {};

    template <class F>
    void Parameters(F&& f) {
      f("tool", tool);
      f("behavior", behavior);
      f("rest", rest);
      f("localization", localization);
      f("observer_gain", observer_gain, "1/s", kPositive);
      f("tare_from_s", tare_from_s, "s", kNotNegative);
      f("tare_until_s", tare_until_s, "s", kNotNegative);
      f("threshold", threshold, "N·m", kPositive);
      f("release", release, "", Between(0, 1));
      f("smallest_lever", smallest_lever, "m", kPositive);
      f("same_point", same_point, "m", kNotNegative);
      f("torque_loop", torque_loop);
    }
  };

  explicit ContactControl(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  InputList<ContactForce> contacts;  ///< of the environment
  Output<JointTorque> torque;        ///< τ_d
  Output<MotorCurrent> current;
  Output<JointTorque> torque_error;        ///< τ_d − B q̈_d − τ, behind the gears
  Output<JointBits> saturated;             ///< joints whose current is cut
  Output<JointAcceleration> acceleration;  ///< q̈_d
  Output<JointTorque> residual;            ///< of the observer, less its offset
  Output<bool> touched;
  Output<int> link;                     ///< the innermost the residual allows; −1: not touched
  Output<JointTorque> external_torque;  ///< Σ J_cᵀ F̂
  Output<Contacts> contact;             ///< with F̂
  Output<ContactObservability> observability;
  Output<ContactLawReport> report;

  /// For each of the places: how far it is from where contact began, and so on.
  std::array<const ContactPlace*, kMaxContacts> places{};
};

}  // namespace pliant
