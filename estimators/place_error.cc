#include "pliant/estimators/place_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace pliant {

PlaceError::PlaceError(const Options& o)
    : places{this, "places"},
      true_contacts{this, "true_contacts"},
      dynamics{this, "dynamics", o.model.joints()},
      distance{this, "distance"},
      model_{o.model} {
  Compute(distance).From(places, true_contacts, dynamics).As(&PlaceError::Largest);
}

double PlaceError::Largest(const Contacts& found, const Contacts& truth,
                           const RobotDynamics& d) const {
  double largest = 0;
  for (const ContactForce& place : found.at) {
    if (!IsLink(model_, place.link)) continue;
    const Eigen::Vector3d x = MotionOf(model_, d, place.link, place.point).position;
    double nearest = std::numeric_limits<double>::infinity();
    for (const ContactForce& contact : truth.at) {
      if (!IsLink(model_, contact.link) || contact.force.isZero()) continue;
      const Eigen::Vector3d on = MotionOf(model_, d, contact.link, contact.point).position;
      nearest = std::min(nearest, (x - on).cross(contact.force.normalized()).norm());
    }
    if (nearest < std::numeric_limits<double>::infinity()) largest = std::max(largest, nearest);
  }
  return largest;
}

}  // namespace pliant
