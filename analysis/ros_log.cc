#include "pliant/analysis/ros_log.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "pliant/systems/error.h"
#include "pliant/systems/nearest_name.h"

namespace pliant::internal {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kBetweenTransforms = kSecond / 100;

/// What rosbag2 wants to know of a publisher. Numbers are those of rmw: keep the last message or
/// all of them, reliable, transient local (1) or volatile (2).
std::string Qos(bool for_latecomers) {
  const std::string forever = ":\n    sec: 9223372036\n    nsec: 854775807\n";
  return std::string("- history: ") + (for_latecomers ? "1\n  depth: 1" : "2\n  depth: 0") +
         "\n  reliability: 1\n  durability: " + (for_latecomers ? "1" : "2") + "\n  deadline" +
         forever + "  lifespan" + forever + "  liveliness: 1\n  liveliness_lease_duration" +
         forever + "  avoid_ros_namespace_conventions: false";
}

std::string Json(const std::vector<std::string>& words) {
  return nlohmann::json(words).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<std::string> Names(const Joints& joints) {
  std::vector<std::string> names;
  for (int i = 0; i < joints.size(); ++i) names.push_back(joints[i]);
  return names;
}

/// "elbow" of "[elbow]".
std::vector<std::string> JointNames(const std::vector<std::string>& elements) {
  std::vector<std::string> names = elements;
  for (std::string& name : names)
    if (name.size() >= 2 && name.front() == '[' && name.back() == ']')
      name = name.substr(1, name.size() - 2);
  return names;
}

std::string List(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return '(' + list + ')';
}

Cdr& PutHeader(Cdr& cdr, std::int64_t time_ns, std::string_view frame) {
  return cdr << static_cast<std::int32_t>(time_ns / kSecond)
             << static_cast<std::uint32_t>(time_ns % kSecond) << frame;
}

}  // namespace

RosLog::RosLog(Options o)
    : options_{std::move(o)},
      joint_states_{NewTopic("/joint_states", JointStateSchema())},
      transforms_{NewTopic("/tf", TransformsSchema())},
      description_{
          NewTopic("/robot_description", StringSchema(), {{"offered_qos_profiles", Qos(true)}})},
      dropped_{NewTopic("/pliant/dropped", Int64Schema())} {
  for (const Topic* topic : {&joint_states_, &transforms_, &description_, &dropped_})
    topics_.insert(topic->name);
  if (options_.robot) links_.emplace(*options_.robot);
}

RosLog::Topic RosLog::NewTopic(const std::string& name, RosSchema schema,
                               MessageSink::Words metadata) const {
  metadata.emplace("offered_qos_profiles", Qos(false));
  return {name, std::move(schema), std::move(metadata)};
}

int RosLog::Open(std::vector<RecordedValue> values) {
  const std::lock_guard lock(mutex_);
  constexpr std::size_t kMostTopics = 65'000;  // MCAP numbers channels by 16 bits
  Require(paths_.size() + values.size() <= kMostTopics,
          "a log has at most " + Text(kMostTopics) + " values", paths_.size() + values.size());
  std::set<std::string> paths = paths_, topics = topics_;
  Stream stream;
  std::size_t begin = 0;
  for (const RecordedValue& value : values) {
    if (!paths.insert(value.path).second)
      throw Error("cannot record " + value.path +
                  " twice in one log\nlet one recorder record it; a diagram that is built again "
                  "needs a log of its own");
    stream.series.push_back({NewTopic(Unlike(topics, TopicOf(value.path), "_"), SchemaOf(value),
                                      {{"pliant.path", value.path},
                                       {"pliant.type", value.type},
                                       {"pliant.elements", Json(value.elements)},
                                       {"pliant.units", Json(value.units)}}),
                             begin, value.elements.size()});
    begin += value.elements.size();
  }
  stream.joints = JointsOf(values);
  paths_ = std::move(paths);
  topics_ = std::move(topics);
  streams_.push_back(std::move(stream));
  return static_cast<int>(streams_.size()) - 1;
}

std::optional<RosLog::JointState> RosLog::JointsOf(const std::vector<RecordedValue>& values) const {
  JointState joints;
  std::string first, missing;  // paths that this stream has and has not
  const auto find = [&](const std::string& path) -> std::optional<std::size_t> {
    if (path.empty()) return std::nullopt;
    std::size_t begin = 0;
    for (const RecordedValue& value : values) {
      if (value.path == path) {
        const std::vector<std::string> names = JointNames(value.elements);
        if (first.empty()) joints.joints = names;
        if (names != joints.joints)
          throw Error("cannot write /joint_states: " + first + " and " + path +
                      " are about different joints\n  " + first + " : " + List(joints.joints) +
                      "\n  " + path + " : " + List(names));
        if (first.empty()) first = path;
        return begin;
      }
      begin += value.elements.size();
    }
    missing = path;
    return std::nullopt;
  };
  joints.position = find(options_.position);
  joints.velocity = find(options_.velocity);
  joints.torque = find(options_.torque);
  if (first.empty()) return std::nullopt;
  if (!missing.empty())
    throw Error("cannot write /joint_states: " + first + " is recorded without " + missing +
                "\nconnect both to one recorder");
  if (!joints.position || !options_.robot) return joints;
  const std::vector<std::string> of_robot = Names(options_.robot->joints());
  if (joints.joints != of_robot)
    throw Error("cannot write /tf: " + options_.position + " is about other joints than " +
                options_.robot->name() + "\n  " + options_.position + " : " + List(joints.joints) +
                "\n  " + options_.robot->name() + " : " + List(of_robot));
  return joints;
}

std::string RosLog::Missing() const {
  const std::lock_guard lock(mutex_);
  for (const std::string& path : {options_.position, options_.velocity, options_.torque})
    if (!path.empty() && !paths_.contains(path))
      return "/joint_states is not in the log: nothing recorded '" + path + "'" +
             DidYouMean(path, {paths_.begin(), paths_.end()});
  return "";
}

RosLog::Stream& RosLog::At(int stream) {
  const auto i = static_cast<std::size_t>(stream);
  if (i >= known_.size()) {
    const std::lock_guard lock(mutex_);
    for (std::size_t k = known_.size(); k < streams_.size(); ++k) known_.push_back(&streams_[k]);
  }
  return *known_[i];
}

std::uint16_t RosLog::ChannelOf(MessageSink& to, Topic& topic) {
  if (topic.channel > 0) return topic.channel;
  auto schema = std::ranges::find(schemas_, topic.schema, &decltype(schemas_)::value_type::first);
  if (schema == schemas_.end()) {
    // Two shapes of one type need two names.
    schemas_.emplace_back(topic.schema, to.AddSchema(Unlike(schema_names_, topic.schema.name),
                                                     "ros2msg", topic.schema.text));
    schema = std::prev(schemas_.end());
  }
  topic.channel = to.AddChannel(schema->second, topic.name, "cdr", topic.metadata);
  return topic.channel;
}

void RosLog::Write(MessageSink& to, Topic& topic, std::int64_t time_ns, const Cdr& message) {
  if (char* at = to.AddMessage(ChannelOf(to, topic), time_ns, message.bytes().size()))
    std::ranges::copy(message.bytes(), at);
}

void RosLog::Write(MessageSink& to, int number, std::int64_t time_ns,
                   std::span<const double> numbers) {
  if (!described_ && !options_.robot_description.empty())
    Write(to, description_, time_ns, Cdr() << std::string_view(options_.robot_description));
  described_ = true;
  Stream& stream = At(number);
  for (Series& series : stream.series) {
    const std::size_t bytes = series.size * sizeof(double);
    char* at = to.AddMessage(ChannelOf(to, series.topic), time_ns, Cdr::kHead.size() + bytes);
    if (!at) continue;
    std::memcpy(at, Cdr::kHead.data(), Cdr::kHead.size());
    std::memcpy(at + Cdr::kHead.size(), numbers.data() + series.begin, bytes);
  }
  if (!stream.joints) return;
  const JointState& joints = *stream.joints;
  WriteJointState(to, joints, time_ns, numbers);
  if (joints.position && links_)
    WriteTransforms(to, time_ns, numbers.subspan(*joints.position, joints.joints.size()));
}

void RosLog::WriteJointState(MessageSink& to, const JointState& joints, std::int64_t time_ns,
                             std::span<const double> numbers) {
  const auto part = [&](const std::optional<std::size_t>& begin) {
    return begin ? numbers.subspan(*begin, joints.joints.size()) : std::span<const double>();
  };
  Cdr message;
  PutHeader(message, time_ns, "") << static_cast<std::uint32_t>(joints.joints.size());
  for (const std::string& joint : joints.joints) message << std::string_view(joint);
  message << part(joints.position) << part(joints.velocity) << part(joints.torque);
  Write(to, joint_states_, time_ns, message);
}

void RosLog::WriteTransforms(MessageSink& to, std::int64_t time_ns,
                             std::span<const double> position) {
  // A run that was restored to an earlier time begins anew.
  if (last_transforms_ns_ && time_ns >= *last_transforms_ns_ &&
      time_ns < *last_transforms_ns_ + kBetweenTransforms)
    return;
  last_transforms_ns_ = time_ns;
  JointPosition q = JointPosition::Zero(links_->model().joints());
  std::ranges::copy(position, q.data());
  const std::vector<LinkTransform>& links = links_->At(q);
  Cdr message;
  message << static_cast<std::uint32_t>(links.size());
  for (const LinkTransform& link : links) {
    const Eigen::Vector3d& p = link.pose.position;
    const Eigen::Quaterniond r(link.pose.rotation);
    PutHeader(message, time_ns, link.parent) << std::string_view(link.child);
    message << p.x() << p.y() << p.z() << r.x() << r.y() << r.z() << r.w();
  }
  Write(to, transforms_, time_ns, message);
}

void RosLog::WriteDropped(MessageSink& to, std::int64_t time_ns, std::int64_t dropped) {
  Write(to, dropped_, time_ns, Cdr() << dropped);
}

}  // namespace pliant::internal
