#pragma once

#include <array>

#include "pliant/plants/contacts.h"
#include "pliant/plants/robot_dynamics.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// A point of an arm that is touched or was, and where it was when that began.
struct AnchoredContact {
  using Space = Nothing;
  static constexpr Quantity quantity{"anchored contact", ""};

  int link = -1;                                     ///< −1: there is none
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< in the link's frame [m]
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< x_d, in the world [m]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< F̂ while it is touched, world axes [N]
  bool touched = false;                              ///< now
  bool begins = false;                               ///< at this tick

  template <class Visitor>
  void Fields(Visitor&& f) {
    f("link", link, "");
    f("point", point, "m");
    f("anchor", anchor, "m");
    f("force", force, "N");
    f("touched", touched, "");
    f("begins", begins, "");
  }
};

/// Follows one place of the contacts from the touch to beyond the release, every h:
///
///   x_d = x_c(t_c),   t_c: the tick at which the contact begins
///
/// While it is touched the point stays the one that was touched first, even if its localisation
/// wanders, as long as it stays on the link and within `same_point` of it; elsewhere it is another
/// contact, with an anchor of its own. Once released, the point and its anchor are kept, so that a
/// controller can bring the point back. They are let go when another place begins to be touched.
/// A point that is touched again before has the anchor it had, or else pushes one after the other
/// would carry the arm along.
///
/// Source: Magrini, Flacco & De Luca 2015 (CF), V: x_d is where the point was when contact began.
class ContactAnchor final : public Block {
 public:
  struct Options {
    RobotModel model;
    int place = 0;             ///< from 0 to kMaxContacts − 1
    Duration period;           ///< h
    double same_point = 0.05;  ///< [m], ≥ 0
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    AnchoredContact contact;
    std::array<bool, kMaxContacts> touched{};  ///< of all places

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("contact", contact, "");
      f("touched", touched, "");
    }
  };

  explicit ContactAnchor(const Options& o);

  Input<Contacts> contacts;  ///< with F̂
  Input<RobotDynamics> dynamics;
  Output<AnchoredContact> contact;
  Output<Position> error;           ///< x_d − x_c; 0 without a point
  Output<LinearVelocity> velocity;  ///< ẋ_c; 0 without a point

 private:
  Memory Next(const Memory& last, const Contacts& contacts, const RobotDynamics& d) const;
  PointMotion Motion(const AnchoredContact& c, const RobotDynamics& d) const;
  Position Error(const AnchoredContact& c, const RobotDynamics& d) const;
  LinearVelocity Velocity(const AnchoredContact& c, const RobotDynamics& d) const;

  const RobotModel model_;
  const std::size_t place_;
  const double same_point_;
  Output<Memory> memory_;
};

}  // namespace pliant
