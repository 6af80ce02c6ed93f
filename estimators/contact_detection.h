#pragma once

#include "pliant/plants/arm_status.h"
#include "pliant/plants/robot_model.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Whether an arm is touched, and how far out, from the residual r of an observer alone. A joint
/// feels a contact from the tick at which |r_i| exceeds its threshold c_i to the one at which it
/// falls below ρ c_i,
///
///   felt_i := |r_i| > c_i  or  (felt_i and |r_i| ≥ ρ c_i),   touched := any felt_i
///
/// sampled every h. The link that the outermost joint of those moves is named: a force on a link is
/// felt by the joints from the base to that link and by none beyond, so the contact is on that link
/// or beyond it.
///
/// What a residual cannot tell: a force through the axis of a joint, or parallel to it, turns it
/// not and leaves nothing in r_i. So a contact may be further out than the link that is named, and
/// one whose force no joint can feel, such as one along the axis of the first link, is not seen at
/// all. Which of two contacts a joint feels it does not tell either.
///
/// Source: Magrini, Flacco & De Luca 2015 (CF); De Luca & Mattone, ICRA 2005.
class ContactDetection final : public Block {
 public:
  struct Options {
    RobotModel model;
    Duration period;       ///< h
    PerJoint threshold;    ///< c_i [N·m], each > 0
    double release = 0.5;  ///< ρ, from 0 to 1
  };

  explicit ContactDetection(const Options& o);

  Input<JointTorque> residual;  ///< r, without its offset
  Output<JointBits> felt;       ///< joints that feel a contact
  Output<bool> touched;
  Output<int> link;      ///< index of the innermost link it may be on; −1: not touched
  Output<double> level;  ///< the largest |r_i|/c_i

 private:
  JointBits Feel(const JointBits& last, const JointTorque& r) const;
  int Isolate(const JointBits& felt) const;
  double Level(const JointTorque& r) const;

  const PerJoint c_;
  const double release_;
  const std::vector<int> outward_;  // joints from the base to the tips
  const std::vector<int> child_;    // link that a joint moves
};

}  // namespace pliant
