#include "pliant/estimators/contact_localization.h"

#include <algorithm>
#include <limits>

#include "pliant/systems/elements.h"

namespace pliant {

using Eigen::Vector3d;
using Place = TouchingPoints::Place;
using Places = TouchingPoints::Places;

namespace {

constexpr double kLinkSlack = 0.02;  // [m] by which another link is nearer before a contact moves
constexpr double kHandAway = 0.03;   // [m] off the surface, where a hand would be seen

std::size_t At(int i) { return static_cast<std::size_t>(i); }

const RobotModel& CheckedModelOf(const ContactLocalization::Options& o) {
  RequireInRange("", o);
  return o.model;
}

}  // namespace

ContactLocalization::ContactLocalization(const Options& o)
    : image{this, "image"},
      dynamics{this, "dynamics", o.model.joints()},
      touched{this, "touched", {}, true},
      isolated{this, "isolated", {}, -1},
      contacts{this, "contacts"},
      sight{this, "sight"},
      model_{CheckedModelOf(o)},
      view_{o.view},
      filter_{{.model = o.model,
               .view = o.view,
               .noise = o.noise,
               .obstacles = o.obstacles,
               .margin = o.margin}},
      points_{filter_,
              o.view,
              o.noise,
              {.reach = o.reach, .band = o.band, .least_points = o.least_points}},
      h_{seconds(o.period)},
      separation_{o.separation},
      smoothing_{o.smoothing},
      contacts_{o.contacts},
      patience_{o.patience},
      known_{this, "known"},
      workspace_{this, "workspace", {filter_.MakeView(), points_.MakeWorkspace()}} {
  Every(o.period)
      .Compute(known_)
      .From(workspace_, known_, clock, image, dynamics, touched, isolated)
      .As(&ContactLocalization::Look);
  Compute(contacts).From(known_).As([](const Known& known) { return known.contacts; });
  Compute(sight).From(known_).As([](const Known& known) { return known.sight; });
}

ContactLocalization::Known ContactLocalization::Look(Workspace& w, const Known& last, double t,
                                                     const DepthImage& picture,
                                                     const RobotDynamics& d, bool is_touched,
                                                     int isolated_link) const {
  Known known = last;
  known.sight.seen = {};
  if (!is_touched) known.contacts = Contacts();
  const bool is_new = picture.time > last.picture && picture.time >= t - 1.01 * h_;
  const bool fits = picture.width == view_.width && picture.height == view_.height;
  if (is_touched && is_new && fits) {
    known.picture = picture.time;
    filter_.Apply(picture, d, w.view);
    Places places = points_.Find(w.view, w.points);
    known.sight.points = places.points;
    Follow(known, places, w.view, d);
    Begin(known, places, d, isolated_link);
    End(known, w.view, d);
  }
  known.sight.age = known.picture < 0 ? -1 : t - known.picture;
  known.sight.unseen = is_touched && known.contacts.count() == 0;
  return known;
}

/// Places that belong to a contact move it, and are no longer there.
void ContactLocalization::Follow(Known& known, Places& places, const SelfFilter::View& view,
                                 const RobotDynamics& d) const {
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  std::array<bool, TouchingPoints::kMaxPlaces> taken{};
  std::array<Vector3d, kMaxContacts> x;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const ContactForce& contact = known.contacts.at[i];
    if (contact.link < 0) continue;
    const Pose X_CL = InCamera(contact.link, d);
    x[i] = X_CL.position + X_CL.rotation * contact.point;
  }
  // A place is of the contact it is nearest to, and moves that one only.
  std::array<const Place*, kMaxContacts> nearest{};
  for (int k = 0; k < places.size; ++k) {
    const Place& place = places.at[At(k)];
    double least = kNowhere;
    std::size_t owner = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (known.contacts.at[i].link < 0) continue;
      const double away = (place.point - x[i]).norm();
      if (away <= separation_ && away < least) least = away, owner = i;
    }
    if (least == kNowhere) continue;
    taken[At(k)] = true;
    if (!nearest[owner] || least < (nearest[owner]->point - x[owner]).norm())
      nearest[owner] = &place;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!nearest[i]) continue;
    MoveTo(known.contacts.at[i], *nearest[i], view, d);
    known.sight.seen[i] = true;
  }
  Places left;
  left.points = places.points;
  for (int k = 0; k < places.size; ++k)
    if (!taken[At(k)]) left.at[At(left.size++)] = places.at[At(k)];
  places = left;
}

void ContactLocalization::MoveTo(ContactForce& contact, const Place& place,
                                 const SelfFilter::View& view, const RobotDynamics& d) const {
  const RobotSurface& surface = filter_.surface();
  const SurfacePoint own = surface.NearestOnLink(contact.link, view.parts, place.point);
  const bool other_link = place.link != contact.link && own.distance > kLinkSlack;
  const Pose X_CL = InCamera(other_link ? place.link : contact.link, d);
  Vector3d x = place.point;
  if (!other_link) {
    const Vector3d was = X_CL.position + X_CL.rotation * contact.point;
    x = surface.NearestOnLink(contact.link, view.parts, was + smoothing_ * (own.point - was)).point;
  }
  if (other_link) contact.link = place.link;
  contact.point = X_CL.rotation.transpose() * (x - X_CL.position);
}

/// The nearest places left, of those apart from each other, become contacts.
void ContactLocalization::Begin(Known& known, const Places& places, const RobotDynamics& d,
                                int isolated_link) const {
  const auto behind = [&](int link) { return link >= 0 && IsBehind(link, isolated_link); };
  const auto first = places.at.begin(), last = first + places.size;
  const bool explained =
      std::ranges::any_of(known.contacts.at, behind, &ContactForce::link) ||
      std::any_of(first, last, [&](const Place& place) { return behind(place.link); });
  if (!explained) return;

  Places left = places;
  const auto best = [&](const Place& a, const Place& b) {
    return std::pair(!behind(a.link), a.distance) < std::pair(!behind(b.link), b.distance);
  };
  std::sort(left.at.begin(), left.at.begin() + left.size, best);
  std::array<Vector3d, TouchingPoints::kMaxPlaces> begun;
  int count = 0;
  for (int k = 0; k < left.size; ++k) {
    const Place& place = left.at[At(k)];
    const auto same = [&](const Vector3d& x) { return (x - place.point).norm() < separation_; };
    if (std::any_of(begun.begin(), begun.begin() + count, same)) continue;
    if (known.contacts.count() >= contacts_) return;
    begun[At(count++)] = place.point;
    const auto free = std::ranges::find(known.contacts.at, -1, &ContactForce::link);
    const std::size_t i = static_cast<std::size_t>(free - known.contacts.at.begin());
    const Pose X_CL = InCamera(place.link, d);
    *free = ContactForce();
    free->link = place.link;
    free->point = X_CL.rotation.transpose() * (place.point - X_CL.position);
    known.sight.seen[i] = true;
    known.missed[i] = 0;
  }
}

void ContactLocalization::End(Known& known, const SelfFilter::View& view,
                              const RobotDynamics& d) const {
  const bool any_seen = std::ranges::find(known.sight.seen, true) != known.sight.seen.end();
  for (std::size_t i = 0; i < known.contacts.at.size(); ++i) {
    ContactForce& contact = known.contacts.at[i];
    if (contact.link < 0) continue;
    if (known.sight.seen[i]) {
      known.missed[i] = 0;
      continue;
    }
    const Pose X_CL = InCamera(contact.link, d);
    const Vector3d x = X_CL.position + X_CL.rotation * contact.point;
    const SurfacePoint on = filter_.surface().NearestOnLink(contact.link, view.parts, x);
    if (!any_seen || filter_.Hides(view, on.point + kHandAway * on.normal)) continue;
    if (++known.missed[i] >= patience_) contact = ContactForce();
  }
}

/// Whether all joints that move `isolated` move the link too.
bool ContactLocalization::IsBehind(int link, int isolated_link) const {
  if (isolated_link < 0 || isolated_link >= std::ssize(model_.links())) return true;
  const int wanted = model_.link(isolated_link).body;
  int body = model_.link(link).body;
  while (body > wanted) body = model_.bodies()[At(body)].parent;
  return body == wanted;
}

Pose ContactLocalization::InCamera(int link, const RobotDynamics& d) const {
  return view_.pose.inverse() * LinkPose(model_, d, link);
}

}  // namespace pliant
