#include "pliant/diagrams/contact_control.h"

#include "pliant/estimators/contact_detection.h"
#include "pliant/estimators/momentum_observer.h"
#include "pliant/plants/model_dynamics.h"
#include "pliant/plants/true_contacts.h"

namespace pliant {

namespace {

/// A number for all joints, or one for each.
PerJoint ForEachJoint(const JointMatrix& given, int n) {
  if (given.size() == 1) return PerJoint::Constant(n, given(0, 0));
  Require(given.cols() == 1 && given.rows() == n,
          "threshold must be a number or one for each of the " + Text(n) + " joints",
          Text(given.rows()) + " x " + Text(given.cols()));
  return given.col(0);
}

}  // namespace

ContactControl::ContactControl(const Options& o)
    : measured_position{this, "measured_position", o.model.joints()},
      measured_velocity{this, "measured_velocity", o.model.joints()},
      measured_torque{this, "measured_torque", o.model.joints()},
      contacts{this, "contacts"},
      torque{this, "torque", o.model.joints()},
      current{this, "current", o.model.joints()},
      torque_error{this, "torque_error", o.model.joints()},
      saturated{this, "saturated"},
      acceleration{this, "acceleration", o.model.joints()},
      residual{this, "residual", o.model.joints()},
      touched{this, "touched"},
      link{this, "link"},
      external_torque{this, "external_torque", o.model.joints()},
      contact{this, "contact"},
      observability{this, "observability"},
      report{this, "report"} {
  const Joints& joints = o.model.joints();
  const int n = o.model.size();

  auto& dynamics =
      Add<ModelDynamics>("dynamics", {.model = o.model, .rotor_inertia = o.rotor_inertia});
  auto& observer =
      Add<MomentumObserver>("observer", {.joints = joints,
                                         .gain = PerJoint::Constant(n, o.observer_gain),
                                         .period = o.period,
                                         .rotor_inertia = o.rotor_inertia});
  auto& tare = Add<ResidualTare>(
      "tare",
      {.joints = joints, .period = o.period, .from_s = o.tare_from_s, .until_s = o.tare_until_s});
  auto& detection = Add<ContactDetection>("detection", {.model = o.model,
                                                        .period = o.period,
                                                        .threshold = ForEachJoint(o.threshold, n),
                                                        .release = o.release});
  auto& truth = Add<TrueContacts>("true_contacts", {.period = o.period});
  auto& estimate = Add<ContactForceEstimate>(
      "estimate", {.model = o.model, .period = o.period, .smallest_lever = o.smallest_lever});
  auto& law = Add<ContactLaw>(
      "law", {.model = o.model, .period = o.period, .posture = o.position, .settings = o.rest});
  auto& actuation = Add<TorqueActuation>("actuation", {.joints = joints,
                                                       .rotor_inertia = o.rotor_inertia,
                                                       .motors = o.low_level,
                                                       .loop = o.torque_loop});

  Connect(measured_position, dynamics.position);
  Connect(measured_velocity, dynamics.velocity);
  Connect(dynamics.dynamics, observer.dynamics);
  Connect(measured_torque, observer.torque);
  Connect(observer.residual, tare.residual);
  Connect(tare.tared, detection.residual);
  Connect(tare.tared, residual);
  Connect(detection.touched, touched);
  Connect(detection.link, link);

  Connect(contacts, truth.forces);
  std::visit([&](const KnownContacts&) { Connect(truth.contacts, estimate.places); },
             o.localization);
  Connect(dynamics.dynamics, estimate.dynamics);
  Connect(tare.tared, estimate.residual);
  Connect(detection.touched, estimate.touched);
  Connect(estimate.contacts, contact);
  Connect(estimate.observability, observability);
  Connect(estimate.explained, external_torque);

  Connect(dynamics.dynamics, law.dynamics);
  Connect(estimate.contacts, law.contacts);
  for (int i = 0; i < kMaxContacts; ++i) {
    auto& place = Add<ContactPlace>("place_" + std::to_string(i + 1), {.model = o.model,
                                                                       .place = i,
                                                                       .period = o.period,
                                                                       .same_point = o.same_point,
                                                                       .behavior = o.behavior});
    Connect(estimate.contacts, place.contacts);
    Connect(truth.contacts, place.true_contacts);
    Connect(dynamics.dynamics, place.dynamics);
    Connect(place.objective, law.objectives);
    places[static_cast<std::size_t>(i)] = &place;
  }
  Connect(law.report, report);
  Connect(law.acceleration, acceleration);
  Connect(law.torque, torque);
  Connect(law.torque, actuation.torque);
  Connect(law.acceleration, actuation.acceleration);
  Connect(measured_velocity, actuation.measured_velocity);
  Connect(measured_torque, actuation.measured_torque);
  Connect(actuation.current, current);
  Connect(actuation.torque_error, torque_error);
  Connect(actuation.saturated, saturated);
}

}  // namespace pliant
