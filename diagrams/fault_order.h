#pragma once

#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// A fault that an emulated device is to show, written `KIND@START+DURATION[:JOINT]`: for example
/// `lost@1+0.5`, or `torque_sensor_dead@1+2:4` for the fourth joint. Seconds from the start of the
/// device.
struct FaultOrder {
  /// What a device can be told to show.
  struct Kind {
    std::string name;
    bool of_joint = false;  ///< whether a joint's number is part of the order

    bool operator==(const Kind&) const = default;
  };

  std::string kind;
  double start_s = 0;
  double duration_s = 0;
  std::optional<int> joint = {};  ///< from 1

  /// Throws Error if it is none, or of a kind that is not known.
  static FaultOrder Of(const std::string& text, const std::vector<Kind>& known);

  /// Whether it is shown at a time: from the start to the end, the end left out.
  bool At(double t) const { return start_s <= t && t < start_s + duration_s; }

  bool operator==(const FaultOrder&) const = default;
};

/// Whether a fault of a kind is ordered for a time.
bool Shows(const std::vector<FaultOrder>& faults, const std::string& kind, double t);

}  // namespace pliant
