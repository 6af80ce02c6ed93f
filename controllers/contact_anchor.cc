#include "pliant/controllers/contact_anchor.h"

namespace pliant {

ContactAnchor::ContactAnchor(const Options& o)
    : contacts{this, "contacts"},
      dynamics{this, "dynamics", o.model.joints()},
      contact{this, "contact"},
      error{this, "error"},
      velocity{this, "velocity"},
      model_{o.model},
      place_{static_cast<std::size_t>(o.place)},
      same_point_{o.same_point},
      memory_{this, "memory"} {
  RequireInRange("", "place", o.place, "", Between(0, kMaxContacts - 1));
  RequireInRange("", "same_point", o.same_point, "m", kNotNegative);
  Every(o.period).Compute(memory_).From(memory_, contacts, dynamics).As(&ContactAnchor::Next);
  Compute(contact).From(memory_).As([](const Memory& m) { return m.contact; });
  Compute(error).From(contact, dynamics).As(&ContactAnchor::Error);
  Compute(velocity).From(contact, dynamics).As(&ContactAnchor::Velocity);
}

PointMotion ContactAnchor::Motion(const AnchoredContact& c, const RobotDynamics& d) const {
  if (!IsLink(model_, c.link)) return {c.anchor, Eigen::Vector3d::Zero()};
  return MotionOf(model_, d, c.link, c.point);
}

Position ContactAnchor::Error(const AnchoredContact& c, const RobotDynamics& d) const {
  return c.anchor - Motion(c, d).position;
}

LinearVelocity ContactAnchor::Velocity(const AnchoredContact& c, const RobotDynamics& d) const {
  return Motion(c, d).velocity;
}

ContactAnchor::Memory ContactAnchor::Next(const Memory& last, const Contacts& all,
                                          const RobotDynamics& d) const {
  Memory now = last;
  bool another_begins = false;
  for (std::size_t i = 0; i < all.at.size(); ++i) {
    now.touched[i] = IsLink(model_, all.at[i].link);
    if (i != place_ && now.touched[i] && !last.touched[i]) another_begins = true;
  }
  const ContactForce& touch = all.at[place_];
  AnchoredContact& c = now.contact;
  const bool same = touch.link == c.link && (touch.point - c.point).norm() <= same_point_;
  c.touched = now.touched[place_];
  c.begins = c.touched && !(same && last.touched[place_]);
  if (c.touched && !same) {
    c.link = touch.link;
    c.point = touch.point;
    c.anchor = MotionOf(model_, d, touch.link, touch.point).position;
  }
  if (c.touched)
    c.force = touch.force;
  else
    c.force.setZero();
  if (!c.touched && another_begins) c = AnchoredContact{};
  return now;
}

}  // namespace pliant
