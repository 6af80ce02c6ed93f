#pragma once

#include <cstdint>

#include "pliant/controllers/objective.h"
#include "pliant/plants/arm_status.h"
#include "pliant/plants/contacts.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// How a tick of ContactLaw ended.
struct ContactLawReport {
  using Space = Nothing;
  static constexpr Quantity quantity{"contact law report", ""};

  enum class Outcome : std::uint8_t {
    Posture,   ///< no objective is active: the posture is held
    Contact,   ///< all active objectives are served
    LeftOut,   ///< some did not fit in
    Fallback,  ///< what came in is no arm: damped gravity compensation
  };

  Outcome outcome = Outcome::Posture;
  int rows = 0;  ///< of the active objectives
  /// The smallest eigenvalue of A M⁻¹ Aᵀ, how readily the arm moves where it does so least; 0
  /// without an objective [1/kg]
  double smallest_mobility = 0;
  JointBits saturated = 0;  ///< joints whose torque is cut

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("outcome", outcome, "");
    f("rows", rows, "");
    f("smallest_mobility", smallest_mobility, "1/kg");
    f("saturated", saturated, "");
  }
};

/// The torque that does what contacts ask for and lets the rest of the arm come to rest. With A and
/// b of all objectives that have a weight, one below the other:
///
///   q̈_d = A#_M b + P q̈_0,   q̈_0 = −K_N q̇                                              (CF 2)
///   A#_M = M⁻¹ Aᵀ (A M⁻¹ Aᵀ)⁻¹,   P = I − A#_M A                                       (CF 4)
///   τ_d = M q̈_d + C q̇ + g − Σ J_cᵀ F̂                                               (CF 19–26)
///
/// sampled every h. A weight only says whether an objective counts; one whose A is zero does not.
/// The inverse is regularised: an eigenvalue k of A M⁻¹ Aᵀ counts as 1/k from k₀ = 1/L on, and
/// below as k/k₀², so where the arm cannot move (k = 0), or two objectives contradict each other,
/// there is nothing, and no inertia exceeds L. P is a projector where no k lies between 0 and k₀.
///
/// As long as no objective counts the arm holds a posture by a damped spring,
///
///   q̈_d = λ₂ (q_h − q) − λ₁ q̇
///
/// q_h is the posture at the start and, later, the one in which the last objective ended.
///
/// τ_d is cut to the torque limits of the joints. Where M has no factorization, or a result is no
/// number, the arm gets g − d q̇.
///
/// Source: Magrini, Flacco & De Luca 2015 (CF).
class ContactLaw final : public Block {
 public:
  struct Settings {
    double null_damping = 20;        ///< K_N [1/s], ≥ 0
    double posture_stiffness = 100;  ///< λ₂ [1/s²], ≥ 0
    double posture_damping = 20;     ///< λ₁ [1/s], ≥ 0
    double inertia_limit = 200;      ///< L [kg], > 0

    template <class F>
    void Parameters(F&& f) {
      f("null_damping", null_damping, "1/s", kNotNegative);
      f("posture_stiffness", posture_stiffness, "1/s²", kNotNegative);
      f("posture_damping", posture_damping, "1/s", kNotNegative);
      f("inertia_limit", inertia_limit, "kg", kPositive);
    }
  };
  struct Options {
    RobotModel model;
    Duration period;        ///< h
    JointPosition posture;  ///< q_h at the start [rad]
    Settings settings = {};
    double fallback_damping = 5;  ///< d [N·m·s/rad], ≥ 0
  };
  /// Most rows of all active objectives; those that do not fit in are left out.
  static constexpr int kMaxRows = 3 * kMaxContacts;

  explicit ContactLaw(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<Contacts> contacts;  ///< with F̂
  InputList<Objective> objectives;
  Output<JointTorque> torque;              ///< τ_d
  Output<JointAcceleration> acceleration;  ///< q̈_d
  Output<ContactLawReport> report;

 private:
  /// What a tick leaves.
  struct Solution {
    JointTorque torque;
    JointAcceleration qdd;
    ContactLawReport report;
    JointPosition posture;  // q_h

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("torque", torque, "N·m");
      f("qdd", qdd, "rad/s²");
      f("report", report, "");
      f("posture", posture, "rad");
    }
  };

  Solution Solve(const Solution& last, const RobotDynamics& d, const Contacts& contacts,
                 const Joined<Objective>& objectives) const;
  JointAcceleration Serve(ContactLawReport& report, const RobotDynamics& d,
                          const Joined<Objective>& objectives) const;
  JointAcceleration Hold(const RobotDynamics& d, const JointPosition& q_h) const;

  const Options o_;
  const JointTorque limit_;
  Output<Solution> solution_;
};

}  // namespace pliant
