#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pliant/plants/actuator_parameters.h"

namespace pliant {

/// A number that was estimated, and the interval that holds the true one in 95 of 100 such fits.
struct FrictionEstimate {
  std::string name;               ///< such as "coulomb", "coulomb_positive" or "offset"
  double value = kToBeGiven;      ///< in SI
  double deviation = kToBeGiven;  ///< standard error
  double low = kToBeGiven, high = kToBeGiven;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("value", value);
    f("deviation", deviation, "", kNotNegative);
    f("low", low);
    f("high", high);
  }
  bool operator==(const FrictionEstimate&) const = default;
};

/// The friction of one joint as it was identified. What could not be told is left out.
struct IdentifiedFriction {
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 16, 16>;

  std::string joint;
  std::optional<double> coulomb = {}, viscous = {}, stiction = {}, stribeck_velocity = {};
  std::int64_t samples = 0;       ///< that the fit has seen
  double residual_deviation = 0;  ///< robust standard deviation of what is left [N·m]
  std::vector<FrictionEstimate> estimates = {};
  Covariance covariance = {};  ///< of the estimates, in their order

  template <class F>
  void Parameters(F&& f) {
    f("joint", joint);
    f("coulomb", coulomb, "N·m", kNotNegative);
    f("viscous", viscous, "N·m·s/rad", kNotNegative);
    f("stiction", stiction, "N·m", kNotNegative);
    f("stribeck_velocity", stribeck_velocity, "rad/s", kPositive);
    f("samples", samples, "", kNotNegative);
    f("residual_deviation", residual_deviation, "N·m", kNotNegative);
    f("estimates", estimates);
    f("covariance", covariance);
  }
};

/// What `pliant identify friction` writes and simulators and controllers load:
///
///   sources: [sweep.mcap]
///   model: stribeck       # that was fitted; "joint_1: stribeck, joint_2: …" where they differ
///   loss: cauchy
///   joints:
///     - joint: joint_1
///       coulomb: 3.01
///       …
///
struct FrictionFile {
  std::vector<std::string> sources = {};  ///< the logs
  std::string model, loss, directions;
  std::vector<IdentifiedFriction> joints = {};

  template <class F>
  void Parameters(F&& f) {
    f("sources", sources);
    f("model", model);
    f("loss", loss);
    f("directions", directions);
    f("joints", joints);
  }

  /// As YAML that ReadFriction reads back exactly.
  std::string text() const;
};

/// Throws Error "file:line:column: …" for what is wrong, also for a joint that is none of `joints`,
/// one given twice, and s < c. Joints may be left out.
FrictionFile ReadFriction(const std::filesystem::path& file, const Joints& joints);
FrictionFile ReadFrictionText(const std::string& text, const Joints& joints,
                              const std::string& source = "YAML");

/// The actuators with what was identified in the place of their figures. Where c is known and s is
/// not, s keeps its ratio to c.
ArmActuators WithFriction(ArmActuators actuators, const Joints& joints,
                          const FrictionFile& friction);

}  // namespace pliant
