#include "pliant/analysis/ros_schema.h"

#include <algorithm>

namespace pliant::internal {
namespace {

constexpr std::string_view kHeader = R"(
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id

================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)";

// Of ASCII alone, whatever the locale.
bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsUpper(char c) { return c >= 'A' && c <= 'Z'; }
bool IsLower(char c) { return c >= 'a' && c <= 'z'; }
bool IsWord(char c) { return IsDigit(c) || IsUpper(c) || IsLower(c); }
char Lower(char c) { return IsUpper(c) ? static_cast<char>(c - 'A' + 'a') : c; }
char Upper(char c) { return IsLower(c) ? static_cast<char>(c - 'a' + 'A') : c; }

/// The letters and digits of a text, the other characters as one underline between them.
std::string Underlined(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (IsWord(c)) {
      out += c;
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  if (!out.empty() && out.back() == '_') out.pop_back();
  return out;
}

std::string FieldName(const std::string& element) {
  std::string name = Underlined(element);
  std::ranges::transform(name, name.begin(), Lower);
  if (name.empty()) return "data";
  return IsDigit(name[0]) ? "e_" + name : name;
}

/// "JointVelocity" of "joint velocity".
std::string MessageName(std::string_view type) {
  std::string name;
  bool begins = true;
  for (const char c : type) {
    if (IsWord(c)) name += begins ? Upper(c) : c;
    begins = !IsWord(c);
  }
  return name.empty() || IsDigit(name[0]) ? "Value" + name : name;
}

}  // namespace

std::string Unlike(std::set<std::string>& taken, const std::string& name,
                   std::string_view separator) {
  std::string unlike = name;
  for (int k = 2; !taken.insert(unlike).second; ++k)
    unlike = name + std::string(separator) + std::to_string(k);
  return unlike;
}

std::vector<std::string> FieldNames(const std::vector<std::string>& elements) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& element : elements)
    names.push_back(Unlike(taken, FieldName(element), "_"));
  return names;
}

RosSchema SchemaOf(const RecordedValue& value) {
  std::string text = "# " + value.type + "\n";
  const std::vector<std::string> names = FieldNames(value.elements);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& unit = value.units[i];
    text += "float64 " + names[i] + (unit.empty() ? "" : "  # " + unit) + '\n';
  }
  return {"pliant/msg/" + MessageName(value.type), text};
}

std::string TopicOf(std::string_view path) {
  std::string topic;
  bool begins = true;
  for (const char c : path) {
    if (begins) topic += '/';
    begins = c == '.';
    if (begins) continue;
    // A part of a topic begins with no digit.
    if (IsDigit(c) && topic.back() == '/') topic += '_';
    topic += IsWord(c) ? c : '_';
  }
  return topic;
}

RosSchema JointStateSchema() {
  return {"sensor_msgs/msg/JointState", R"(std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
)" + std::string(kHeader)};
}

RosSchema TransformsSchema() {
  return {"tf2_msgs/msg/TFMessage", R"(geometry_msgs/TransformStamped[] transforms

================================================================================
MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
geometry_msgs/Transform transform

================================================================================
MSG: geometry_msgs/Transform
geometry_msgs/Vector3 translation
geometry_msgs/Quaternion rotation

================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z

================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
)" + std::string(kHeader)};
}

RosSchema StringSchema() { return {"std_msgs/msg/String", "string data\n"}; }
RosSchema Int64Schema() { return {"std_msgs/msg/Int64", "int64 data\n"}; }

}  // namespace pliant::internal
