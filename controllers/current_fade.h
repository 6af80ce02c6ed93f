#pragma once

#include <algorithm>

#include "pliant/controllers/arm_control.h"
#include "pliant/plants/arm_status.h"
#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// The current of the torque loop that moves an arm, without a jump where that changes, every h. At
/// the tick of a change the current stays what it was; what the new loop wants otherwise fades in
/// within T,
///
///   i = i_loop + (1 − t/T) (i_0 − i_loop(0)),   t = 0 … T
///
/// i_0 is the command of the tick before, or after position control the measured current. Under
/// position control the measured current is passed on.
class CurrentFade final : public Block {
 public:
  struct Options {
    Joints joints;
    double change_s = 0.5;  ///< T > 0
    Duration period;        ///< h
  };

  explicit CurrentFade(const Options& o)
      : control{this, "control"},
        kinova{this, "kinova", o.joints},
        proposed{this, "proposed", o.joints},
        kinova_saturated{this, "kinova_saturated", {}, 0},
        proposed_saturated{this, "proposed_saturated", {}, 0},
        measured_current{this, "measured_current", o.joints},
        current{this, "current", o.joints},
        saturated{this, "saturated"},
        part_{seconds(o.period) / o.change_s},
        memory_{
            this,
            "memory",
            {},
            {.current = MotorCurrent::Zero(o.joints), .difference = MotorCurrent::Zero(o.joints)}} {
    RequireInRange("", "change_s", o.change_s, "s", kPositive);
    Every(o.period)
        .Compute(memory_)
        .From(memory_, control, kinova, proposed, measured_current)
        .As(&CurrentFade::Next);
    Compute(current).From(memory_).As([](const Memory& m) { return m.current; });
    Compute(saturated)
        .From(control, kinova_saturated, proposed_saturated)
        .As([](ArmControl c, JointBits of_kinova, JointBits of_proposed) {
          return c == ArmControl::KinovaTorque     ? of_kinova
                 : c == ArmControl::ProposedTorque ? of_proposed
                                                   : JointBits{0};
        });
  }

  Input<ArmControl> control;             ///< what moves the arm
  Input<MotorCurrent> kinova, proposed;  ///< of the two loops
  Input<JointBits> kinova_saturated, proposed_saturated;
  Input<MotorCurrent> measured_current;
  Output<MotorCurrent> current;  ///< i
  Output<JointBits> saturated;   ///< joints whose current the loop cuts

 private:
  struct Memory {
    ArmControl control = ArmControl::ProposedTorque;
    bool started = false;
    double left = 0;  // 1 − t/T
    MotorCurrent current, difference;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("control", control, "");
      f("started", started, "");
      f("left", left, "");
      f("current", current, "A");
      f("difference", difference, "A");
    }
  };

  Memory Next(const Memory& last, ArmControl now, const MotorCurrent& of_kinova,
              const MotorCurrent& of_proposed, const MotorCurrent& measured) const {
    Memory m = last;
    m.control = now;
    m.started = true;
    if (now == ArmControl::Position) {
      m.left = 0;
      m.current = measured;
      return m;
    }
    const MotorCurrent& loop = now == ArmControl::KinovaTorque ? of_kinova : of_proposed;
    if (last.started && now != last.control) {
      m.left = 1;
      m.difference =
          (last.control == ArmControl::Position ? measured : last.current) - PerJoint(loop);
    } else {
      m.left = std::max(0.0, last.left - part_);
    }
    m.current = loop + m.left * m.difference;
    return m;
  }

  const double part_;
  Output<Memory> memory_;
};

}  // namespace pliant
