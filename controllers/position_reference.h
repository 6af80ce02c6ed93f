#pragma once

#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Turns the accelerations of a controller into positions for an arm that is commanded those, by
/// integration from its start, whatever the arm does (open loop), sampled every h:
///
///   q_{k+1} = q_k + h q̇_k + ½ h² q̈_k,   q̇_{k+1} = q̇_k + h q̈_k
///
/// exact for q̈_d held over the sample. The controller is asked about this reference instead of the
/// measured state; what pushes the arm reaches it through τ̂_e alone. Not finite numbers of q̈_d
/// leave the reference where it is, at rest. While `follow` is true, q_k and q̇_k are what is
/// measured (closed loop), where that is finite; the reference goes on from there.
///
/// Source: named as future work by Celerier et al. 2025.
class PositionReference final : public Block {
 public:
  struct Options {
    Joints joints;
    JointPosition start;  ///< q_0 [rad]
    Duration period;      ///< h
  };

  explicit PositionReference(const Options& o)
      : acceleration{this, "acceleration", o.joints},
        follow{this, "follow", {}, false},
        measured_position{this, "measured_position", o.joints, JointPosition::Zero(o.joints)},
        measured_velocity{this, "measured_velocity", o.joints, JointVelocity::Zero(o.joints)},
        position{this, "position", o.joints, o.start},
        velocity{this, "velocity", o.joints},
        open{this, "open", o.joints, o.start},
        h_{seconds(o.period)},
        q_{this, "q", o.joints, o.start},
        v_{this, "v", o.joints} {
    const PeriodicEvent tick = Every(o.period);
    tick.Update(q_).From(position, velocity, acceleration).As(&PositionReference::Position);
    tick.Update(v_).From(velocity, acceleration).As(&PositionReference::Velocity);
    tick.Compute(position)
        .From(q_, follow, measured_position)
        .As([](const JointPosition& q, bool follows, const JointPosition& measured) {
          return follows && measured.allFinite() ? measured : q;
        });
    tick.Compute(open).From(q_).As([](const JointPosition& q) { return q; });
    tick.Compute(velocity)
        .From(v_, follow, measured_velocity)
        .As([](const JointVelocity& v, bool follows, const JointVelocity& measured) {
          return follows && measured.allFinite() ? measured : v;
        });
  }

  Input<JointAcceleration> acceleration;  ///< q̈_d
  Input<bool> follow;                     ///< no if not connected
  Input<JointPosition> measured_position;
  Input<JointVelocity> measured_velocity;
  Output<JointPosition> position;  ///< q_k
  Output<JointVelocity> velocity;  ///< q̇_k
  Output<JointPosition> open;      ///< q_k as if it did not follow

 private:
  JointPosition Position(const JointPosition& q, const JointVelocity& v,
                         const JointAcceleration& a) const {
    return a.allFinite() ? JointPosition(q + h_ * v + 0.5 * h_ * h_ * a) : q;
  }
  JointVelocity Velocity(const JointVelocity& v, const JointAcceleration& a) const {
    return a.allFinite() ? JointVelocity(v + h_ * a) : JointVelocity(0 * v);
  }

  const double h_;
  Discrete<JointPosition> q_;
  Discrete<JointVelocity> v_;
};

}  // namespace pliant
