#pragma once

#include <variant>

#include "pliant/controllers/contact_anchor.h"
#include "pliant/controllers/contact_force_control.h"
#include "pliant/controllers/contact_impedance.h"
#include "pliant/estimators/contact_force_estimate.h"
#include "pliant/systems/composite.h"

namespace pliant {

/// What is to happen where an arm is touched.
using ContactBehavior = std::variant<ContactImpedance::Gains, ContactForceControl::Settings>;

/// Controls the motion or the force at one place of the contacts.
///
///   contacts, dynamics ─▶ anchor ─▶ impedance or force control ─▶ objective
///   contacts, true_contacts, observability ─▶ force_error, observed_error
class ContactPlace final : public Composite {
 public:
  struct Options {
    RobotModel model;
    int place = 0;
    Duration period;
    double same_point = 0.05;  ///< as ContactAnchor has it [m]
    ContactBehavior behavior = {};
    double weight = 1;  ///< of the objective
  };

  explicit ContactPlace(const Options& o);

  Input<Contacts> contacts;                   ///< with F̂
  Input<Contacts> true_contacts;              ///< for the errors only
  Input<ContactObservability> observability;  ///< for `observed_error` only
  Input<RobotDynamics> dynamics;
  Output<AnchoredContact> contact;
  Output<Position> error;           ///< x_d − x_c, from where contact began
  Output<LinearVelocity> velocity;  ///< ẋ_c
  Output<Force> force;              ///< F̂
  Output<Force> force_error;        ///< F̂ − F of the nearest true contact
  /// The rows of this place of U_r U_rᵀ (F̂ − F), of all places: what is off of the part of the
  /// forces that joints feel.
  Output<Force> observed_error;
  Output<Force> wanted;               ///< F_d; 0 unless a force is regulated
  Output<ContactForceStatus> status;  ///< of the force control; Idle with an impedance
  Output<Objective> objective;
};

}  // namespace pliant
