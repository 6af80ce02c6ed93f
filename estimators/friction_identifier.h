#pragma once

#include <Eigen/Core>

#include "pliant/estimators/friction_fit.h"
#include "pliant/systems/block.h"

namespace pliant {

/// How far the friction of a joint is known.
enum class FrictionStatus {
  Gathering,         ///< nothing was solved yet
  TooFewSamples,     ///< the joint has not slid enough
  PartlyIdentified,  ///< what the samples do not tell is 0, its standard error too
  Identified
};

/// The friction of each joint as it was identified; 0 where it was not.
struct IdentifiedJoints {
  using Space = Joints;
  static constexpr Quantity quantity{"identified friction", ""};

  PerJoint coulomb, viscous, stiction, stribeck_velocity, offset;
  /// Their standard errors.
  PerJoint coulomb_error, viscous_error, stiction_error, stribeck_error, offset_error;
  PerJoint coulomb_viscous;  ///< covariance of the two that a compensation uses
  PerJoint residual;         ///< σ of what is left [N·m]
  PerJoint lack_of_fit;
  PerJoint status;  ///< a FrictionStatus

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("coulomb", coulomb, "N·m");
    f("viscous", viscous, "N·m·s/rad");
    f("stiction", stiction, "N·m");
    f("stribeck_velocity", stribeck_velocity, "rad/s");
    f("offset", offset, "N·m");
    f("coulomb_error", coulomb_error, "N·m");
    f("viscous_error", viscous_error, "N·m·s/rad");
    f("stiction_error", stiction_error, "N·m");
    f("stribeck_error", stribeck_error, "rad/s");
    f("offset_error", offset_error, "N·m");
    f("coulomb_viscous", coulomb_viscous, "N²·m²·s/rad");
    f("residual", residual, "N·m");
    f("lack_of_fit", lack_of_fit, "N·m");
    f("status", status, "");
  }
};

/// Gathers samples of the friction torque over the velocity and fits a law to them when it is told
/// to, see FitFriction:
///
///   y = τ_m − τ − B q̈
///
/// While `gate` is true each tick gives a sample of each joint. Memory is bounded: when `capacity`
/// samples of a joint are there, every second one is given up, and from then on every second one is
/// not taken, again and again, so that they are spread evenly over all that was seen.
///
/// At the tick at which `trigger` becomes true all joints are solved. That tick allocates and takes
/// milliseconds: let the arm stand, or do it in simulation. All others neither allocate nor wait.
class FrictionIdentifier final : public Block {
 public:
  struct Options {
    Joints joints;
    Duration period;
    PerJoint reflected_inertia = {};  ///< B [kg·m²], each ≥ 0; empty: none
    FrictionFitOptions fit = {.folds = 0};
    int capacity = 1024;  ///< samples of each joint, ≥ 64
  };

  /// What was gathered, a column for each joint.
  struct Memory {
    using Space = Joints;
    static constexpr Quantity quantity{"gathered samples", ""};

    Eigen::MatrixXd velocity, torque;
    int count = 0;      ///< rows in use
    double stride = 1;  ///< one in so many samples is taken
    double seen = 0;    ///< samples while the gate was open
    bool triggered = false;
    bool solve = false;  ///< the trigger has just become true
    template <class Visitor>
    void Fields(Visitor&& f) {
      f("velocity", velocity, "rad/s");
      f("torque", torque, "N·m");
      f("count", count, "");
      f("stride", stride, "");
      f("seen", seen, "");
      f("triggered", triggered, "");
      f("solve", solve, "");
    }
  };

  explicit FrictionIdentifier(const Options& o);

  Input<JointVelocity> velocity;
  Input<JointTorque> motor_torque;  ///< τ_m = κ i
  Input<JointTorque> torque;        ///< τ, as measured
  Input<JointAcceleration> acceleration;
  Input<bool> trigger;
  Input<bool> gate;  ///< true if not connected
  Output<IdentifiedJoints> friction;

 private:
  void Gather(Memory& m, const JointVelocity& v, const JointTorque& tau_m, const JointTorque& tau,
              const JointAcceleration& a, bool trigger_now, bool gate_now) const;
  void Solve(IdentifiedJoints& found, const Memory& m) const;

  const PerJoint B_;
  const FrictionFitOptions fit_;
  const int capacity_;
  Output<Memory> memory_;
};

}  // namespace pliant
