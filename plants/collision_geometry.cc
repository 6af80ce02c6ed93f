#include "pliant/plants/collision_geometry.h"

#include <algorithm>
#include <set>
#include <utility>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

std::size_t At(int i) { return static_cast<std::size_t>(i); }

using Part = CollisionGeometry::Part;
using LinkPairs = std::set<std::pair<int, int>>;  // the smaller index first

std::pair<int, int> Ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// Indices of links; those that a model may lack are left out if it does.
std::vector<int> Indices(const RobotModel& model, const CollisionPairs& pairs,
                         const std::vector<std::string>& names) {
  std::vector<int> all;
  for (const std::string& name : names) {
    const auto is_it = [&](const Link& link) { return link.name == name; };
    const bool may_lack = std::ranges::find(pairs.optional, name) != pairs.optional.end();
    if (may_lack && std::ranges::none_of(model.links(), is_it)) continue;
    all.push_back(model.link_index(name));
  }
  return all;
}

LinkPairs PairsOf(const RobotModel& model, const CollisionPairs& pairs,
                  const std::vector<CollisionPairs::Group>& groups) {
  LinkPairs all;
  for (const CollisionPairs::Group& group : groups) {
    Require(!group.links.empty() && !group.against.empty(),
            "a group of pairs names `links` and links `against` which they are");
    for (const int a : Indices(model, pairs, group.links))
      for (const int b : Indices(model, pairs, group.against)) all.insert(Ordered(a, b));
  }
  return all;
}

bool AreAdjacent(const RobotModel& model, int a, int b) {
  const auto parent = [&](int body) { return body < 0 ? -2 : model.bodies()[At(body)].parent; };
  return a == b || parent(a) == b || parent(b) == a;
}

/// Of shape k of a link.
std::string PartName(const Link& link, std::size_t k) {
  const std::string& name = link.collisions[k].name;
  if (link.collisions.size() == 1) return link.name;
  if (name.empty()) return link.name + "_" + std::to_string(k + 1);
  return name.starts_with(link.name) ? name : link.name + "_" + name;
}

std::vector<Part> PartsOf(const RobotModel& model) {
  std::vector<Part> parts;
  for (int i = 0; i < std::ssize(model.links()); ++i) {
    const Link& link = model.link(i);
    for (std::size_t k = 0; k < link.collisions.size(); ++k)
      parts.push_back(
          {PartName(link, k), i, link.body, CollisionShape::Of(link.collisions[k]).In(link.pose)});
  }
  return parts;
}

void RequireShapes(const RobotModel& model, const LinkPairs& watched) {
  for (const auto& [a, b] : watched)
    for (const int link : {a, b})
      Require(!model.link(link).collisions.empty(),
              "the watched link '" + model.link(link).name + "' has no collision shape");
}

}  // namespace

CollisionGeometry::CollisionGeometry(const RobotModel& model, const CollisionPairs& pairs,
                                     const std::vector<Obstacle>& obstacles) {
  const LinkPairs watched = PairsOf(model, pairs, pairs.watch);
  const LinkPairs ignored = PairsOf(model, pairs, pairs.ignore);
  RequireShapes(model, watched);

  std::vector<Part> parts = PartsOf(model);
  const int of_links = static_cast<int>(parts.size());
  std::vector<std::pair<int, int>> found;
  for (int b = 0; b < of_links; ++b)
    for (int a = b + 1; a < of_links; ++a) {
      const std::pair<int, int> links = Ordered(parts[At(a)].link, parts[At(b)].link);
      if (!AreAdjacent(model, parts[At(a)].body, parts[At(b)].body) && !ignored.contains(links) &&
          (pairs.watch.empty() || watched.contains(links)))
        found.emplace_back(a, b);
    }
  for (const Obstacle& obstacle : obstacles) {
    const std::string& name = NameOf(obstacle);
    parts.push_back({name, -1, -1, ShapeOf(obstacle)});
    const auto same = [&](const Part& part) { return part.name == name; };
    Require(std::ranges::count_if(parts, same) == 1,
            "an obstacle must have a name that no other and no link has", name);
    std::vector<int> excepted;
    for (const std::string& link : ExceptedBy(obstacle)) excepted.push_back(model.link_index(link));
    for (int a = 0; a < of_links; ++a)
      if (parts[At(a)].body >= 0 &&
          std::ranges::find(excepted, parts[At(a)].link) == excepted.end())
        found.emplace_back(a, static_cast<int>(parts.size()) - 1);
  }
  Require(std::ssize(found) <= kMaxCollisionPairs,
          "at most " + Text(kMaxCollisionPairs) +
              " pairs of shapes are kept apart; name fewer in `watch`, or more in `ignore` or "
              "`except`",
          found.size());

  std::vector<std::string> names;
  std::vector<int> index(parts.size(), -1);
  const auto keep = [&](int part) {
    if (index[At(part)] < 0) {
      index[At(part)] = static_cast<int>(parts_.size());
      parts_.push_back(parts[At(part)]);
    }
    return index[At(part)];
  };
  for (const auto& [a, b] : found) {
    names.push_back(parts[At(b)].name + "-" + parts[At(a)].name);
    pairs_.push_back({keep(a), keep(b)});
  }
  names_ = PairNames(std::move(names));
}

void CollisionGeometry::Place(const RobotDynamics& d, Placement& placement) const {
  static const Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Part& part = parts_[i];
    if (part.body >= 0) {
      const BodyMotion& body = d.body[At(part.body)];
      placement[i] = PlacedShape(part.shape, body.rotation, body.position);
    } else {
      placement[i].shape = &part.shape;
      placement[i].rotation = &upright;
      placement[i].center = part.shape.center;
      placement[i].half = part.shape.half;
    }
  }
}

PairDistances CollisionGeometry::Distances(const RobotDynamics& d, double softening) const {
  Placement placement;
  Place(d, placement);
  PairDistances all = PairDistances::Zero(names_);
  for (int i = 0; i < size(); ++i) {
    const Pair& pair = pairs_[At(i)];
    all(i) = Closest(placement[At(pair.a)], placement[At(pair.b)], softening).distance;
  }
  return all;
}

}  // namespace pliant
