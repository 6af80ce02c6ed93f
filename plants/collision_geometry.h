#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "pliant/plants/collision_distance.h"
#include "pliant/plants/collision_pairs.h"
#include "pliant/plants/obstacle.h"
#include "pliant/plants/robot_dynamics.h"

namespace pliant {

/// Largest number of pairs of shapes that are kept apart.
inline constexpr int kMaxCollisionPairs = 64;

/// Names of pairs, such as base_link-bracelet_link.
class PairNames : public Space {
 public:
  PairNames() = default;
  explicit PairNames(std::vector<std::string> names) : Space(std::move(names)) {}
};

/// The distance e of each pair; below zero in penetration.
struct PairDistances : Signal<PairDistances, PairNames, Eigen::Dynamic, kMaxCollisionPairs> {
  using Signal::Signal;
  static constexpr Quantity quantity{"distances", "m"};
};

/// What can collide: shapes on links and obstacles in the world, in pairs.
///
/// The shapes of two links are a pair as CollisionPairs says; an obstacle is in a pair with each
/// shape of each link that moves and that it does not except. A pair has the names of its links,
/// such as base_link-bracelet_link; a link with several shapes, those of the shapes.
class CollisionGeometry {
 public:
  struct Part {
    std::string name;
    int link = -1;         ///< index in the model, −1: an obstacle
    int body = -1;         ///< that carries it, −1: the world
    CollisionShape shape;  ///< in the frame of the body
  };
  /// Indices of parts; an obstacle is a b.
  struct Pair {
    int a, b;
  };
  /// Where the parts are, in their order.
  using Placement = std::array<PlacedShape, 2 * kMaxCollisionPairs>;

  CollisionGeometry(const RobotModel& model, const CollisionPairs& pairs,
                    const std::vector<Obstacle>& obstacles);

  std::span<const Part> parts() const { return parts_; }  ///< that are in a pair
  std::span<const Pair> pairs() const { return pairs_; }
  const PairNames& names() const { return names_; }
  int size() const { return static_cast<int>(pairs_.size()); }  ///< number of pairs

  const Part& part(int index) const { return parts_[static_cast<std::size_t>(index)]; }

  /// Where the parts are in the world. `d` is referred to, and must stay. No heap, no exceptions.
  void Place(const RobotDynamics& d, Placement& placement) const;

  /// Of all pairs. No heap, no exceptions.
  PairDistances Distances(const RobotDynamics& d, double softening = 0) const;

 private:
  std::vector<Part> parts_;
  std::vector<Pair> pairs_;
  PairNames names_;
};

}  // namespace pliant
