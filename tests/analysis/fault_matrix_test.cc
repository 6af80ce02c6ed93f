#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>

#include "pliant/analysis/recording.h"
#include "pliant/diagrams/command_faults.h"
#include "pliant/tests/analysis/lock_step_gen3.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::HasSubstr;

constexpr double kFault = 1.2;     // when the faults begin: the arm circles [s]
constexpr double kDuration = 1.6;  // and when the user stops it, if nothing else has

/// What came of a run with a fault.
struct Outcome {
  ArmRun run;
  std::string cause, path;
  double at_rest = 0;  ///< since the fault [s]
  double moved = 0;    ///< of any joint, since the fault [rad]
  bool handed_back = false;
};

template <class Enum>
std::string Word(Enum value) {
  return Words(value)[static_cast<std::size_t>(value)];
}

Outcome RunWith(const std::string& fault, ControlMode mode, const std::string& safety = "") {
  const TemporaryDirectory folder;
  const std::string kind = fault.substr(0, fault.find('@'));
  const auto ours = CommandFaults::Kinds();
  const bool is_ours =
      std::ranges::any_of(ours, [&](const FaultOrder::Kind& k) { return k.name == kind; });
  const bool is_word = kind == "user_stop" || kind.empty();
  LockStepGen3 gen3(is_ours || is_word ? std::vector<std::string>{} : std::vector{fault});
  ArmRunOptions o{.out = folder.path(), .connect = gen3.connect()};
  if (is_ours) o.faults = {FaultOrder::Of(fault, ours)};
  if (kind == "user_stop")
    gen3.at = [panel = o.panel](double t) {
      if (t >= kFault) panel->stop = true;
    };
  const auto file = ExperimentFile::ReadText(
      CirclingArm(mode, OnArm(gen3.address()),
                  "safety: {hold_s: 0.5" + safety + "}\nduration_s: " + Text(kDuration) + "\n"),
      "circling.yaml");
  Outcome out;
  out.run = RunOnArm(file, o);
  EXPECT_EQ(gen3.failure(), "");

  const Recording log = Recording::Read(out.run.log);
  const RecordedSignal& report = log["safety.report"];
  std::string last;
  for (const double s : report[".state"]) {
    const std::string state = Word(static_cast<SafetyState>(s));
    if (state != std::exchange(last, state)) out.path += (out.path.empty() ? "" : " → ") + state;
  }
  const Eigen::Index end = report.numbers.cols() - 1;
  out.cause = Word(static_cast<SafetyCause>(report[".cause"](end)));
  EXPECT_EQ(out.cause, Word(out.run.safety.cause)) << "the log is complete to the end";
  EXPECT_EQ(end + 1, out.run.timing.ticks) << "a row for each tick";
  if (const int joint = static_cast<int>(report[".joint"](end)); joint >= 0)
    out.cause += ":" + std::to_string(joint + 1);

  const SimulatedArm::Options arm = StationOf(file.scenarios.front());
  const PerJoint tau_max = arm.model.effort_limit();
  const PerJoint i_max = FiguresOf(arm.actuators.joint, &ActuatorParameters::current_limit);
  const auto within = [&](const auto& x, const PerJoint& limit) {
    return x.allFinite() && (x.array().abs() <= limit.array() + 1e-5).all();  // single precision
  };
  for (const char* path : {"safety.arm_torque", "safety.arm_current"}) {
    const bool torque = std::string(path).ends_with("torque");
    const RecordedSignal& sent = log[path];
    for (Eigen::Index k = 0; k <= end; ++k)
      if (!within(sent.numbers.col(k), torque ? tau_max : i_max)) {
        ADD_FAILURE() << path << " at " << sent.times(k) << " s: " << sent.numbers.col(k);
        break;
      }
  }
  const std::vector<Gen3Moment> moments = gen3.moments();
  const Gen3Moment* begin = nullptr;
  const double rest = SafetySupervisor::Settings().rest_speed;
  for (const Gen3Moment& m : moments) {
    if (m.t < kFault) continue;
    if (!begin) begin = &m;
    out.moved = std::max(out.moved, (m.position - begin->position).cwiseAbs().maxCoeff());
    if (m.velocity.cwiseAbs().maxCoeff() > rest) out.at_rest = m.t - kFault;
    // What it received first was its own measurement.
    if (!within(m.torque, tau_max) || !within(m.current, i_max)) {
      ADD_FAILURE() << "received at " << m.t << " s";
      break;
    }
  }
  if (!begin) return ADD_FAILURE() << "the arm was never servoed", out;
  EXPECT_LT(moments.back().velocity.cwiseAbs().maxCoeff(), rest) << "at rest in the end";
  out.handed_back = out.run.handing_back.empty();
  return out;
}

TEST(FaultMatrix, Prints) {
  const char* only = std::getenv("FAULT");
  for (const ControlMode mode : {ControlMode::Position, ControlMode::Torque,
                                 ControlMode::TorqueHighVelocity, ControlMode::Current})
    for (const char* fault :
         {"", "lost@1.2+0.003", "lost@1.2+0.4", "late@1.2+0.003", "late@1.2+0.4",
          "duplicated@1.2+0.4", "reordered@1.2+0.001", "reordered@1.2+0.4", "corrupted@1.2+0.001",
          "corrupted@1.2+0.4", "truncated@1.2+0.4", "lost_requests@1.2+0.003",
          "lost_requests@1.2+0.4", "silent@1.2+0.003", "silent@1.2+0.4", "frozen@1.2+0.4",
          "nan@1.2+0.4", "actuator_fault@1.2+0.4:4", "following_error@1.2+0.4:4",
          "overspeed@1.2+0.4:2", "torque_sensor_dead@1.2+0.4:2", "torque_jump@1.2+0.4:2",
          "encoder_jump@1.2+0.4:4", "emergency_stop@1.2+0.4", "session_expired@1.2+0.4",
          "tcp_reset@1.2+0.4", "servoing_refused@0+9", "slow_services@0+9", "nan_command@1.2+0.4",
          "command_jump@1.2+0.4", "divergence@1.2+0.4", "overruns@1.2+0.4", "user_stop@1.2+0"}) {
      if (only && std::string(fault).find(only) == std::string::npos) continue;
      SCOPED_TRACE(std::string(fault) + " " + Word(mode));
      const auto t = std::chrono::steady_clock::now();
      const Outcome o = RunWith(fault, mode);
      std::printf("%-28s %-20s %-22s %-55s rest %.3f moved %.4f end %.3f wall %.2f %s\n",
                  fault, Word(mode).c_str(), o.cause.c_str(), o.path.c_str(), o.at_rest, o.moved,
                  o.run.timing.ticks * 1e-3,
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count(),
                  o.run.handing_back.c_str());
      std::fflush(stdout);
    }
}

}  // namespace
}  // namespace pliant
