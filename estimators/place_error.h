#pragma once

#include "pliant/plants/contacts.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"

namespace pliant {

/// How far off the places are that are taken for contacts: the largest distance of one to the
/// nearest line of a true force,
///
///   max_i min_j ‖(x_i − x_j) × F_j/‖F_j‖‖
///
/// A force acts along its line, so a place on it explains all of it, wherever on it its point is
/// said to be. 0 where there is no contact, or no force.
class PlaceError final : public Block {
 public:
  struct Options {
    RobotModel model;
  };

  explicit PlaceError(const Options& o);

  Input<Contacts> places;
  Input<Contacts> true_contacts;
  Input<RobotDynamics> dynamics;
  Output<double> distance;  ///< [m]

 private:
  double Largest(const Contacts& places, const Contacts& truth, const RobotDynamics& d) const;

  const RobotModel model_;
};

}  // namespace pliant
