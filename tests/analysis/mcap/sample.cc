// Writes a log, and beside it what should be in it, for readers of others.
//
//   analysis_mcap_sample FILE EXPECTED     a log and its contents as JSON
//   analysis_mcap_sample --killed FILE     a log of rows of 1 ms until SIGKILL, after 1.2 s

#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "pliant/analysis/mcap_log.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/recorder.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

const char* const kArm = R"(<robot name="planar">
  <link name="base"/>
  <link name="upper"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.3"/><axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 1 0"/></joint>
  <joint name="flange" type="fixed"><parent link="lower"/><child link="tool"/>
    <origin xyz="0.4 0 0" rpy="0 0 1.5707963267948966"/></joint>
</robot>
)";

/// Records into a log and into memory.
class Tee final : public RecordSink {
 public:
  explicit Tee(std::shared_ptr<McapLog> log) : log_{std::move(log)} {}

  int Open(std::vector<RecordedValue> values) override {
    streams_.push_back(values);
    return log_->Open(std::move(values));
  }
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override {
    stream_ = static_cast<std::size_t>(stream);
    time_ns_ = time_ns;
    return row_ = log_->Begin(stream, time_ns);
  }
  void Commit() noexcept override {
    std::size_t begin = 0;
    for (const RecordedValue& value : streams_[stream_]) {
      const auto numbers = row_.subspan(begin, value.elements.size());
      begin += numbers.size();
      rows_[value.path].push_back({{"time", std::to_string(time_ns_)},
                                   {"numbers", std::vector(numbers.begin(), numbers.end())}});
    }
    log_->Commit();
  }

  nlohmann::json Contents() const {
    nlohmann::json all = nlohmann::json::array();
    for (const auto& stream : streams_)
      for (const RecordedValue& value : stream)
        all.push_back({{"path", value.path},
                       {"type", value.type},
                       {"elements", value.elements},
                       {"units", value.units},
                       {"rows", rows_.at(value.path)}});
    return all;
  }

 private:
  const std::shared_ptr<McapLog> log_;
  std::vector<std::vector<RecordedValue>> streams_;
  std::map<std::string, std::vector<nlohmann::json>> rows_;
  std::size_t stream_ = 0;
  std::int64_t time_ns_ = 0;
  std::span<double> row_;
};

/// Two joints that turn, each at its own speed.
class Arm final : public Block {
 public:
  explicit Arm(const Joints& joints)
      : position{this, "position", joints}, velocity{this, "velocity", joints} {
    Compute(position).From(clock).As([](double t) { return JointPosition{t, -2 * t}; });
    Compute(velocity).From(clock).As([](double) { return JointVelocity{1, -2}; });
  }
  Output<JointPosition> position;
  Output<JointVelocity> velocity;
};

int WriteSample(const std::string& file, const std::string& expected) {
  const RobotModel robot = RobotModel::FromUrdfText(kArm);
  const auto log = std::make_shared<McapLog>(
      McapLog::Options{.file = file,
                       .force = true,
                       .metadata = {{"pliant", {{"seed", "7"}, {"scenario", "arm: {}\nμ: 1\n"}}}},
                       .robot = robot,
                       .robot_description = kArm,
                       .position = "arm.position",
                       .velocity = "arm.velocity"});
  const auto sink = std::make_shared<Tee>(log);
  DiagramBuilder b;
  auto& arm = b.Add<Arm>("arm", robot.joints());
  auto& pose = b.Add<Constant<Pose>>("pose", {});
  auto& twist = b.Add<Constant<Twist>>("twist", {.space = "tool", .value = {1, 2, 3, 4, 5, 6}});
  auto& flag = b.Add<Constant<bool>>("flag", {.value = true});
  auto& gain = b.Add<Constant<PerJoint>>(
      "gain-2", {.space = robot.joints(), .value = PerJoint::Constant(2, 0.1)});
  auto& fast = b.Add<Recorder>("fast", {.period = 1ms, .sink = sink});
  auto& slow = b.Add<Recorder>("slow", {.period = Hertz(30), .sink = sink});
  b.Connect(arm.position, fast.in);
  b.Connect(arm.velocity, fast.in);
  b.Connect(flag.y, fast.in);
  b.Connect(pose.y, slow.in);
  b.Connect(twist.y, slow.in);
  b.Connect(gain.y, slow.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(10);  // several chunks
  log->Close();
  std::ofstream(expected) << nlohmann::json{{"values", sink->Contents()}, {"description", kArm}};
  return 0;
}

[[noreturn]] int WriteUntilKilled(const std::string& file) {
  McapLog log({.file = file, .force = true});
  const int stream = log.Open({{"count", "double", {""}, {""}}});
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0;; ++k) {
    std::this_thread::sleep_until(begin + k * 1ms);
    log.Begin(stream, k * 1'000'000)[0] = k;
    log.Commit();
    if (k == 1200) kill(getpid(), SIGKILL);
  }
}

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  return argv[1] == std::string_view("--killed") ? pliant::WriteUntilKilled(argv[2])
                                                 : pliant::WriteSample(argv[1], argv[2]);
}
