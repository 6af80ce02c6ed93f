#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/record_sink.h"

namespace pliant::internal {

/// The name and the text of a ROS 2 message type, with those of the types in it.
struct RosSchema {
  std::string name, text;

  bool operator==(const RosSchema&) const = default;
};

/// Fields for elements, in order, such as "elbow" for "[elbow]", "force_x" for ".force[x]", "e_0_1"
/// for "[0,1]" and "data" for "": small letters, digits and single underlines, a letter first.
/// Where two would be the same, the later one gets a number: "elbow_2".
std::vector<std::string> FieldNames(const std::vector<std::string>& elements);

/// A message with a number for each element, and the element's unit behind it as a comment. It is
/// named after the value's type: "pliant/msg/JointVelocity".
RosSchema SchemaOf(const RecordedValue& value);

/// The topic of a path, such as "/arm/measured_velocity" for "arm.measured_velocity".
std::string TopicOf(std::string_view path);

/// `name`, or the first of name2, name3, … that is not in `taken`; adds it there.
std::string Unlike(std::set<std::string>& taken, const std::string& name,
                   std::string_view separator = "");

RosSchema JointStateSchema();
RosSchema TransformsSchema();
RosSchema StringSchema();
RosSchema Int64Schema();

}  // namespace pliant::internal
