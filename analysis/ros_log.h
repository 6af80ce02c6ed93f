#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pliant/analysis/cdr.h"
#include "pliant/analysis/link_transforms.h"
#include "pliant/analysis/message_sink.h"
#include "pliant/analysis/ros_schema.h"

namespace pliant::internal {

/// Rows of recorded values as ROS 2 messages of a file or of a server: a topic for each value, and
/// the topics that tools show a robot from.
///
/// The metadata of a value's channel is what RecordedValue holds: "pliant.path", "pliant.type" and,
/// as JSON arrays, "pliant.elements" and "pliant.units".
class RosLog {
 public:
  struct Options {
    std::optional<RobotModel> robot;
    std::string robot_description;
    std::string position, velocity, torque;  ///< paths
  };

  explicit RosLog(Options o);

  /// Takes the values of rows to come; returns the number of their stream. Throws Error.
  int Open(std::vector<RecordedValue> values);

  /// What the options name and no stream has, as a message; empty if there is nothing.
  std::string Missing() const;

  // What follows is for the thread that writes.

  void Write(MessageSink& to, int stream, std::int64_t time_ns, std::span<const double> numbers);
  /// On /pliant/dropped: how many rows found no room until now.
  void WriteDropped(MessageSink& to, std::int64_t time_ns, std::int64_t dropped);

 private:
  struct Topic {
    std::string name;
    RosSchema schema;
    MessageSink::Words metadata;
    std::uint16_t channel = 0;  // 0: not in the file yet
  };
  struct Series {  // of one value
    Topic topic;
    std::size_t begin, size;  // of its numbers in the row
  };
  struct JointState {
    std::vector<std::string> joints;
    std::optional<std::size_t> position, velocity, torque;  // where they begin in the row
  };
  struct Stream {
    std::vector<Series> series;
    std::optional<JointState> joints;
  };

  Topic NewTopic(const std::string& name, RosSchema schema, MessageSink::Words metadata = {}) const;
  std::optional<JointState> JointsOf(const std::vector<RecordedValue>& values) const;
  Stream& At(int stream);
  std::uint16_t ChannelOf(MessageSink& to, Topic& topic);
  void Write(MessageSink& to, Topic& topic, std::int64_t time_ns, const Cdr& message);
  void WriteJointState(MessageSink& to, const JointState& joints, std::int64_t time_ns,
                       std::span<const double> numbers);
  void WriteTransforms(MessageSink& to, std::int64_t time_ns, std::span<const double> position);

  const Options options_;
  mutable std::mutex mutex_;  // of what Open adds to
  std::set<std::string> paths_, topics_;
  std::deque<Stream> streams_;

  // Of the thread that writes.
  std::vector<Stream*> known_;
  std::vector<std::pair<RosSchema, std::uint16_t>> schemas_;
  std::set<std::string> schema_names_;
  Topic joint_states_, transforms_, description_, dropped_;
  bool described_ = false;
  std::optional<std::int64_t> last_transforms_ns_;
  std::optional<LinkTransforms> links_;
};

}  // namespace pliant::internal
