#include "pliant/diagrams/contact_tasks.h"

#include "pliant/estimators/contact_detection.h"
#include "pliant/estimators/place_error.h"
#include "pliant/estimators/residual_tare.h"
#include "pliant/plants/true_contacts.h"
#include "pliant/systems/constant.h"

namespace pliant {

namespace {

/// What acts at the points that are controlled: F̂ where contact began, wherever it is found since.
class ActingContacts final : public Block {
 public:
  ActingContacts() { Compute(contacts).From(first, second, third).As(&ActingContacts::Gather); }

  Input<AnchoredContact> first{this, "first"}, second{this, "second"}, third{this, "third"};
  Output<Contacts> contacts{this, "contacts"};

 private:
  Contacts Gather(const AnchoredContact& a, const AnchoredContact& b,
                  const AnchoredContact& c) const {
    const auto of = [](const AnchoredContact& contact) {
      ContactForce force;
      if (!contact.touched) return force;
      force.link = contact.link;
      force.point = contact.point;
      force.force = contact.force;
      return force;
    };
    return {.at = {of(a), of(b), of(c)}};
  }
};

/// A number for all joints, or one for each.
PerJoint ForEachJoint(const JointMatrix& given, int n) {
  if (given.size() == 1) return PerJoint::Constant(n, given(0, 0));
  Require(given.cols() == 1 && given.rows() == n,
          "threshold must be a number or one for each of the " + Text(n) + " joints",
          Text(given.rows()) + " x " + Text(given.cols()));
  return given.col(0);
}

}  // namespace

ContactTasks::ContactTasks(const Options& o)
    : dynamics{this, "dynamics", o.model.joints()},
      raw_residual{this, "raw_residual", o.model.joints()},
      forces{this, "forces"},
      residual{this, "residual", o.model.joints()},
      touched{this, "touched"},
      link{this, "link"},
      external_torque{this, "external_torque", o.model.joints()},
      contacts{this, "contacts"},
      acting{this, "acting"},
      observability{this, "observability"},
      sight{this, "sight"},
      place_error{this, "place_error"},
      objectives{{{this, "objective_1", o.model.joints()},
                  {this, "objective_2", o.model.joints()},
                  {this, "objective_3", o.model.joints()}}} {
  static_assert(kMaxContacts == 3);
  const ContactSettings& s = o.settings;
  auto& tare = Add<ResidualTare>("tare", {.joints = o.model.joints(),
                                          .period = o.period,
                                          .from_s = s.tare_from_s,
                                          .until_s = s.tare_until_s});
  auto& detection =
      Add<ContactDetection>("detection", {.model = o.model,
                                          .period = o.period,
                                          .threshold = ForEachJoint(s.threshold, o.model.size()),
                                          .release = s.release});
  auto& truth = Add<TrueContacts>("true_contacts", {.period = o.period});
  auto& estimate = Add<ContactForceEstimate>(
      "estimate", {.model = o.model, .period = o.period, .smallest_lever = s.smallest_lever});

  Connect(raw_residual, tare.residual);
  Connect(tare.tared, detection.residual);
  Connect(tare.tared, residual);
  Connect(detection.touched, touched);
  Connect(detection.link, link);
  Connect(forces, truth.forces);
  if (const auto* seen = std::get_if<SeenContacts>(&s.localization)) {
    image.emplace(this, "image");
    auto& localization = Add<ContactLocalization>("localization", LocalizationOf(*seen, o.model));
    auto& error = Add<PlaceError>("found", {.model = o.model});
    Connect(*image, localization.image);
    Connect(dynamics, localization.dynamics);
    Connect(detection.touched, localization.touched);
    Connect(detection.link, localization.isolated);
    Connect(localization.contacts, estimate.places);
    Connect(localization.sight, sight);
    Connect(localization.contacts, error.places);
    Connect(truth.contacts, error.true_contacts);
    Connect(dynamics, error.dynamics);
    Connect(error.distance, place_error);
  } else {
    Connect(truth.contacts, estimate.places);
    Connect(Add<Constant<ContactSight>>("no_sight", {.value = ContactSight()}).y, sight);
    Connect(Add<Constant<double>>("no_error", {.value = 0.0}).y, place_error);
  }
  Connect(dynamics, estimate.dynamics);
  Connect(tare.tared, estimate.residual);
  Connect(detection.touched, estimate.touched);
  Connect(estimate.contacts, contacts);
  Connect(estimate.observability, observability);
  Connect(estimate.explained, external_torque);
  auto& gathered = Add<ActingContacts>("gathered");
  const std::array<Input<AnchoredContact>*, kMaxContacts> acts{&gathered.first, &gathered.second,
                                                               &gathered.third};
  Connect(gathered.contacts, acting);
  for (int i = 0; i < kMaxContacts; ++i) {
    auto& place = Add<ContactPlace>("place_" + std::to_string(i + 1), {.model = o.model,
                                                                       .place = i,
                                                                       .period = o.period,
                                                                       .same_point = s.same_point,
                                                                       .behavior = s.behavior,
                                                                       .weight = o.weight});
    Connect(estimate.contacts, place.contacts);
    Connect(truth.contacts, place.true_contacts);
    Connect(estimate.observability, place.observability);
    Connect(dynamics, place.dynamics);
    const auto k = static_cast<std::size_t>(i);
    Connect(place.objective, objectives[k]);
    Connect(place.contact, *acts[k]);
    places[k] = &place;
  }
}

}  // namespace pliant
