#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pliant/plants/robot_model.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Which links of a robot are kept apart: all pairs, or those that are watched, without those that
/// are ignored. Links of one body, and of two that one joint connects, are never a pair.
struct CollisionPairs {
  /// Each of `links` with each of `against`.
  struct Group {
    std::vector<std::string> links, against;

    template <class F>
    void Parameters(F&& f) {
      f("links", links);
      f("against", against);
    }
    bool operator==(const Group&) const = default;
  };

  std::vector<Group> watch = {};           ///< none: all pairs
  std::vector<Group> ignore = {};          ///< also of what is watched
  std::vector<std::string> optional = {};  ///< links that a model may lack

  template <class F>
  void Parameters(F&& f) {
    f("watch", watch);
    f("ignore", ignore);
    f("optional", optional);
  }

  /// Reads a file such as models/gen3/collisions.yaml:
  ///
  ///   watch:
  ///     - {links: [base_link, shoulder_link], against: [bracelet_link, FT_adapter]}
  ///   ignore:
  ///     - {links: [spherical_wrist_1_link], against: [bracelet_link]}
  ///   optional: [FT_adapter]
  ///
  /// What is wrong, such as a link that the model does not have, is an Error "file:line:column: …".
  static CollisionPairs Read(const std::filesystem::path& file, const RobotModel& model);
  static CollisionPairs ReadText(const std::string& text, const RobotModel& model,
                                 const std::string& source = "YAML");

  bool operator==(const CollisionPairs&) const = default;
};

}  // namespace pliant
