#pragma once

#include <algorithm>
#include <cmath>

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
/// i_0 is the command of the tick before, or after position control the measured current. The sum
/// is cut at ± i_max. Under position control the measured current is passed on. Where a difference
/// at a change is no number the joint does without a fade.
class CurrentFade final : public Block {
 public:
  struct Options {
    Joints joints;
    double change_s = 0.5;            ///< T > 0
    MotorCurrent current_limit = {};  ///< i_max [A], each > 0; empty: none
    Duration period;                  ///< h
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
        i_max_{o.current_limit.size() > 0
                   ? PerJoint(o.current_limit)
                   : PerJoint(PerJoint::Constant(o.joints.size(), kUnbounded))},
        memory_{
            this,
            "memory",
            {},
            {.current = MotorCurrent::Zero(o.joints), .difference = MotorCurrent::Zero(o.joints)}} {
    RequireInRange("", "change_s", o.change_s, "s", kPositive);
    RequireEachInRange("current_limit", i_max_, "A", kLimit, o.joints);
    Every(o.period)
        .Compute(memory_)
        .From(memory_, control, kinova, proposed, measured_current)
        .As(&CurrentFade::Next);
    Compute(current).From(memory_).As([](const Memory& m) { return m.current; });
    Compute(saturated)
        .From(memory_, control, kinova_saturated, proposed_saturated)
        .As([](const Memory& m, ArmControl c, JointBits of_kinova, JointBits of_proposed) {
          return c == ArmControl::KinovaTorque     ? of_kinova | m.cut
                 : c == ArmControl::ProposedTorque ? of_proposed | m.cut
                                                   : JointBits{0};
        });
  }

  Input<ArmControl> control;             ///< what moves the arm
  Input<MotorCurrent> kinova, proposed;  ///< of the two loops
  Input<JointBits> kinova_saturated, proposed_saturated;
  Input<MotorCurrent> measured_current;
  Output<MotorCurrent> current;  ///< i
  Output<JointBits> saturated;   ///< joints whose current is cut, of the loop or of the sum

 private:
  struct Memory {
    ArmControl control = ArmControl::ProposedTorque;
    bool started = false;
    double left = 0;  // 1 − t/T
    MotorCurrent current, difference;
    JointBits cut = 0;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("control", control, "");
      f("started", started, "");
      f("left", left, "");
      f("current", current, "A");
      f("difference", difference, "A");
      f("cut", cut, "");
    }
  };

  Memory Next(const Memory& last, ArmControl now, const MotorCurrent& of_kinova,
              const MotorCurrent& of_proposed, const MotorCurrent& measured) const {
    Memory m = last;
    m.control = now;
    m.started = true;
    m.cut = 0;
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
      for (double& x : m.difference)
        if (!std::isfinite(x)) x = 0;
    } else {
      m.left = std::max(0.0, last.left - part_);
    }
    if (m.left == 0) {
      m.current = loop;
      return m;
    }
    const PerJoint sum = loop + m.left * m.difference;
    for (Eigen::Index j = 0; j < sum.size(); ++j)
      if (std::abs(sum(j)) > i_max_(j)) m.cut |= JointBits{1} << j;
    m.current = sum.cwiseMin(i_max_).cwiseMax(-i_max_);
    return m;
  }

  const double part_;
  const PerJoint i_max_;
  Output<Memory> memory_;
};

}  // namespace pliant
