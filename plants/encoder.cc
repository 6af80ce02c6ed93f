#include "pliant/plants/encoder.h"

#include <cmath>
#include <numbers>

#include "pliant/systems/elements.h"

namespace pliant {

namespace {

PerJoint CheckedCounts(const Encoder::Options& o) {
  RequireEachInRange("counts_per_turn", o.counts_per_turn, "", {.least = 1}, o.joints);
  for (int i = 0; i < o.joints.size(); ++i)
    Require(o.counts_per_turn(i) == std::round(o.counts_per_turn(i)),
            "counts_per_turn[" + o.joints[i] + "] must be whole", o.counts_per_turn(i));
  return o.counts_per_turn;
}

}  // namespace

const std::vector<std::string>& Words(EncoderVelocity) {
  static const std::vector<std::string> words{"difference", "period"};
  return words;
}

Encoder::Encoder(const Options& o)
    : position{this, "position", o.joints},
      counts{this, "counts", o.joints},
      measured_position{this, "measured_position", o.joints},
      measured_velocity{this, "measured_velocity", o.joints},
      per_turn_{CheckedCounts(o)},
      quantum_{2 * std::numbers::pi * per_turn_.cwiseInverse()},
      offset_{EachInRangeOr0("offset", o.offset, "rad", kAnyNumber, o.joints)},
      one_turn_{o.one_turn},
      velocity_{o.velocity},
      h_{seconds(o.period)},
      change_{this,
              "change",
              {},
              Change{PerJoint::Zero(o.joints.size()), PerJoint::Constant(o.joints.size(), -1)}} {
  const PeriodicEvent tick = Every(o.period);
  tick.Compute(counts).From(position).As(&Encoder::Count);
  tick.Compute(measured_position).From(counts).As(&Encoder::MeasurePosition);
  tick.Compute(measured_velocity)
      .From(measured_velocity, counts, change_)
      .As(&Encoder::MeasureVelocity);
  tick.Update(change_).From(counts, change_).As(&Encoder::Remember);
}

PerJoint Encoder::Count(const JointPosition& q) const {
  PerJoint c = (q - offset_).cwiseQuotient(quantum_).array().round();
  if (one_turn_)
    for (Eigen::Index i = 0; i < c.size(); ++i)
      c(i) -= per_turn_(i) * std::floor(c(i) / per_turn_(i));
  return c;
}

JointPosition Encoder::MeasurePosition(const PerJoint& c) const {
  return offset_ + quantum_.cwiseProduct(c);
}

/// The way from one count to another, the shorter one of two round a turn.
double Encoder::Moved(Eigen::Index i, double now, double before) const {
  const double way = now - before;
  return one_turn_ ? way - per_turn_(i) * std::round(way / per_turn_(i)) : way;
}

JointVelocity Encoder::MeasureVelocity(const JointVelocity& last, const PerJoint& c,
                                       const Change& change) const {
  JointVelocity v(PerJoint::Zero(c.size()));
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    if (change.ticks(i) < 0) continue;
    const double moved = Moved(i, c(i), change.counts(i));
    const double ticks = velocity_ == EncoderVelocity::Period ? change.ticks(i) + 1 : 1;
    const double step = quantum_(i) / (ticks * h_);
    if (velocity_ == EncoderVelocity::Difference || moved != 0)
      v(i) = moved * step;
    else
      v(i) = std::copysign(std::min(std::abs(last(i)), step), last(i));
  }
  return v;
}

Encoder::Change Encoder::Remember(const PerJoint& c, const Change& change) const {
  Change next = change;
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    const bool changed = change.ticks(i) < 0 || Moved(i, c(i), change.counts(i)) != 0;
    next.ticks(i) = changed ? 0 : change.ticks(i) + 1;
    if (changed) next.counts(i) = c(i);
  }
  return next;
}

}  // namespace pliant
