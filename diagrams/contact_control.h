#pragma once

#include <optional>
#include <string>

#include "pliant/controllers/contact_law.h"
#include "pliant/diagrams/contact_tasks.h"
#include "pliant/diagrams/torque_actuation.h"

namespace pliant {

/// Controls motion or force wherever an arm is touched, without a sensor of force.
///
///   measured_… ─▶ dynamics ─▶ observer ─▶ tasks ─▶ law ─▶ actuation ─▶ current
///   contacts ────────────────────────────▶         └──▶ torque
///
/// Until a contact has begun the arm holds its posture.
///
/// The rotors are part of what the controller moves, and so of the natural inertia of a contact;
/// the observer, which is driven by torque sensors behind the gears, takes them off again.
///
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
    ContactSettings contact = {};
    ContactLaw::Settings rest = {};  ///< of what contacts leave free
    double observer_gain = 50;       ///< K_I [1/s]
    TorqueLoopChoice torque_loop = {};

    template <class F>
    void Parameters(F&& f) {
      f("tool", tool);
      contact.Parameters(f);
      f("rest", rest);
      f("observer_gain", observer_gain, "1/s", kPositive);
      f("torque_loop", torque_loop);
    }
  };

  explicit ContactControl(const Options& o);

  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Input<JointTorque> measured_torque;
  InputList<ContactForce> contacts;  ///< of the environment
  /// Of the camera, if contacts are seen.
  std::optional<Input<DepthImage>> image;
  Output<JointTorque> torque;  ///< τ_d
  Output<MotorCurrent> current;
  Output<JointTorque> torque_error;        ///< τ_d − B q̈_d − τ, behind the gears
  Output<JointBits> saturated;             ///< joints whose current is cut
  Output<JointAcceleration> acceleration;  ///< q̈_d
  Output<ContactLawReport> report;

  const ContactTasks* contact_tasks;
};

}  // namespace pliant
