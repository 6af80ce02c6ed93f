#pragma once

#include <memory>
#include <string>

#include "pliant/controllers/contact_anchor.h"
#include "pliant/controllers/contact_force_control.h"
#include "pliant/controllers/contact_impedance.h"
#include "pliant/controllers/contact_law.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"

namespace pliant {

/// A mass on three slides along x, y and z, without weight: CF's single mass along each of them.
inline RobotModel Mass(double m) {
  const std::string link = R"(<inertial><mass value="0"/>
    <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>)";
  const auto slide = [](const std::string& name, const std::string& from, const std::string& to,
                        const std::string& axis) {
    return "<joint name=\"" + name + "\" type=\"prismatic\"><parent link=\"" + from +
           "\"/><child link=\"" + to + "\"/><axis xyz=\"" + axis +
           "\"/><limit lower=\"-9\" upper=\"9\" velocity=\"99\" effort=\"1e6\"/></joint>";
  };
  const std::string text =
      "<robot name=\"mass\"><link name=\"base\"/><link name=\"first\"/><link name=\"second\"/>"
      "<link name=\"mass\"><inertial><mass value=\"" +
      std::to_string(m) +
      "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
      "izz=\"1\"/></inertial></link>" +
      slide("x", "base", "first", "1 0 0") + slide("y", "first", "second", "0 1 0") +
      slide("z", "second", "mass", "0 0 1") + "</robot>";
  return RobotModel::FromUrdfText(text, "mass.urdf").WithGravity({0, 0, 0});
}

/// The law of one place, its state and what is known of the contacts given by hand:
///
///   q, q̇ ─▶ dynamics ─▶ anchor ─▶ impedance or force control ─▶ law
///   contacts ─▶ anchor, law
struct ContactRig {
  ContactRig(const RobotModel& m, const ContactImpedance::Gains& gains,
             const ContactLaw::Settings& settings = {})
      : ContactRig(m, settings) {
    impedance = &b.Add<ContactImpedance>("impedance", {.model = m, .gains = gains});
    b.Connect(anchor->contact, impedance->contact);
    b.Connect(dynamics->dynamics, impedance->dynamics);
    b.Connect(impedance->objective, law->objectives);
    Build();
  }
  ContactRig(const RobotModel& m, const ContactForceControl::Settings& force_settings,
             const ContactLaw::Settings& settings = {})
      : ContactRig(m, settings) {
    force = &b.Add<ContactForceControl>("force",
                                        {.model = m, .period = 1ms, .settings = force_settings});
    b.Connect(anchor->contact, force->contact);
    b.Connect(dynamics->dynamics, force->dynamics);
    b.Connect(force->objective, law->objectives);
    Build();
  }

  /// τ_d for a state and contacts.
  const JointTorque& Torque(const JointPosition& at, const JointVelocity& rate,
                            const Contacts& touched) {
    sim->Set(q->value, at);
    sim->Set(v->value, rate);
    sim->Set(contacts->value, touched);
    sim->AdvanceThroughTick();
    return sim->Get(law->torque);
  }
  template <class V>
  const typename V::Signal& Get(const V& value) {
    return sim->Get(value);
  }
  RobotDynamics At(const JointPosition& at, const JointVelocity& rate) const {
    RobotDynamics d(model);
    ComputeDynamics(model, at, rate, d);
    return d;
  }

  RobotModel model;
  DiagramBuilder b;
  Constant<JointPosition>* q;
  Constant<JointVelocity>* v;
  Constant<Contacts>* contacts;
  ModelDynamics* dynamics;
  ContactAnchor* anchor;
  ContactImpedance* impedance = nullptr;
  ContactForceControl* force = nullptr;
  ContactLaw* law;
  std::unique_ptr<Diagram> diagram;
  std::unique_ptr<Simulator> sim;

 private:
  ContactRig(const RobotModel& m, const ContactLaw::Settings& settings) : model{m} {
    const Joints& joints = m.joints();
    q = &b.Add<Constant<JointPosition>>("q",
                                        {.space = joints, .value = JointPosition::Zero(joints)});
    v = &b.Add<Constant<JointVelocity>>("v",
                                        {.space = joints, .value = JointVelocity::Zero(joints)});
    contacts = &b.Add<Constant<Contacts>>("contacts", {.value = Contacts{}});
    dynamics = &b.Add<ModelDynamics>("dynamics", {.model = m});
    anchor = &b.Add<ContactAnchor>("anchor", {.model = m, .place = 0, .period = 1ms});
    law = &b.Add<ContactLaw>(
        "law",
        {.model = m, .period = 1ms, .posture = JointPosition::Zero(joints), .settings = settings});
    b.Connect(q->y, dynamics->position);
    b.Connect(v->y, dynamics->velocity);
    b.Connect(dynamics->dynamics, anchor->dynamics);
    b.Connect(contacts->y, anchor->contacts);
    b.Connect(dynamics->dynamics, law->dynamics);
    b.Connect(contacts->y, law->contacts);
  }
  void Build() {
    diagram = std::make_unique<Diagram>(b.Build());
    sim = std::make_unique<Simulator>(*diagram);
  }
};

/// One contact, at place 0.
inline Contacts TouchedAt(int link, const Eigen::Vector3d& point, const Eigen::Vector3d& force) {
  Contacts contacts;
  contacts.at[0] = {link, point, force, Eigen::Vector3d::Zero()};
  return contacts;
}

}  // namespace pliant
