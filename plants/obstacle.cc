#include "pliant/plants/obstacle.h"

#include <Eigen/Geometry>

#include "pliant/systems/elements.h"

namespace pliant {

CollisionShape BoxObstacle::shape() const {
  const auto about = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis);
  };
  const Eigen::Matrix3d R =
      (about(rpy.z(), Eigen::Vector3d::UnitZ()) * about(rpy.y(), Eigen::Vector3d::UnitY()) *
       about(rpy.x(), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return CollisionShape::Box({center, R}, size);
}

const std::string& NameOf(const Obstacle& obstacle) {
  return std::visit([](const auto& o) -> const std::string& { return o.name; }, obstacle);
}

const std::vector<std::string>& ExceptedBy(const Obstacle& obstacle) {
  return std::visit([](const auto& o) -> const std::vector<std::string>& { return o.except; },
                    obstacle);
}

CollisionShape ShapeOf(const Obstacle& obstacle) {
  return std::visit(
      [](const auto& given) {
        auto o = given;
        Require(!o.name.empty(), "an obstacle must have a name");
        o.Parameters([&](std::string_view name, const auto& value, std::string_view unit = {},
                         const Range& range = kAnyNumber) {
          using T = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<T, double> || internal::Dense<T>)
            RequireEachInRange(o.name + ": " + std::string(name), value, unit, range);
        });
        try {
          return o.shape();
        } catch (const Error& error) {
          throw Error(o.name + ": " + error.what());
        }
      },
      obstacle);
}

}  // namespace pliant
