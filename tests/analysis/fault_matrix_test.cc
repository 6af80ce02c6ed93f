#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <utility>

#include "pliant/analysis/recording.h"
#include "pliant/diagrams/command_faults.h"
#include "pliant/tests/analysis/lock_step_gen3.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::StrEq;

constexpr double kFault = 1.2;     // when faults begin: the arm circles at 0.1 m/s [s]
constexpr double kDuration = 1.6;  // when the user stops it, if nothing else has [s]

/// What becomes of the controller.
enum class Then {
  GoesOn,  ///< nothing, until the user stops it
  Damps,   ///< Damped, Holding, Stopped; position control has nothing to damp and holds at once
  Holds,   ///< Holding, Stopped
  Waits,   ///< it never had the arm
};

/// The matrix, whatever the mode.
struct Row {
  const char* fault;  ///< KIND@START+DURATION[:JOINT]; of the arm, the network, or our own side
  const char* cause;
  Then then;
};

// Faults that are shorter than stale_after, 5 ticks, or that leave fresh numbers, do not stop the
// arm. Most of the others last as long as the controller would have run.
constexpr Row kMatrix[] = {
    {"none@1.2+0", "user_stop", Then::GoesOn},
    {"lost@1.2+0.003", "user_stop", Then::GoesOn},
    {"lost@1.2+0.4", "stale_feedback", Then::Holds},
    {"late@1.2+0.003", "user_stop", Then::GoesOn},
    {"late@1.2+0.4", "stale_feedback", Then::Holds},
    {"duplicated@1.2+0.4", "user_stop", Then::GoesOn},
    {"reordered@1.2+0.4", "user_stop", Then::GoesOn},
    {"corrupted@1.2+0.001", "user_stop", Then::GoesOn},
    // One in some hundred can still be read and is a position nowhere near.
    {"corrupted@1.2+0.4", "position_jump", Then::Damps},
    {"truncated@1.2+0.4", "stale_feedback", Then::Holds},
    {"lost_requests@1.2+0.003", "user_stop", Then::GoesOn},
    {"lost_requests@1.2+0.4", "stale_feedback", Then::Holds},
    {"silent@1.2+0.003", "user_stop", Then::GoesOn},
    {"silent@1.2+0.4", "stale_feedback", Then::Holds},
    {"frozen@1.2+0.4", "stale_feedback", Then::Holds},
    {"nan@1.2+0.003", "user_stop", Then::GoesOn},
    {"nan@1.2+0.4", "stale_feedback", Then::Holds},
    {"actuator_fault@1.2+0.4:4", "joint_fault", Then::Holds},
    {"following_error@1.2+0.4:4", "joint_fault", Then::Holds},
    {"overspeed@1.2+0.4:2", "joint_fault", Then::Holds},
    {"torque_sensor_dead@1.2+0.4:2", "joint_fault", Then::Holds},
    // No torque is so far off that it could not be: the limits of commands bound what comes of it.
    {"torque_jump@1.2+0.4:2", "user_stop", Then::GoesOn},
    {"torque_jump@1.2+0.4:6", "torque_jump", Then::Holds},
    {"encoder_jump@1.2+9:4", "position_jump", Then::Damps},
    {"emergency_stop@1.2+0.4", "arm_fault", Then::Holds},
    {"session_expired@1.2+0.4", "not_connected", Then::Holds},
    {"tcp_reset@1.2+0.4", "not_connected", Then::Holds},
    {"servoing_refused@0+9", "not_connected", Then::Waits},
    {"slow_services@0+9", "user_stop", Then::GoesOn},
    {"nan_command@1.2+0.4", "command_not_finite", Then::Damps},
    {"command_jump@1.2+0.4", "command_jump", Then::Damps},
    {"divergence@1.2+0.4", "divergence", Then::Damps},
    {"overruns@1.2+0.4", "overruns", Then::Damps},
    {"user_stop@1.2+0", "user_stop", Then::Damps},
};

std::string PathOf(const Row& row, ControlMode mode) {
  const bool leads = mode == ControlMode::Position;
  std::string path = "engaging, ";
  if (row.then != Then::Waits) path += "running, ";
  if (!leads && (row.then == Then::GoesOn || row.then == Then::Damps)) path += "damped, ";
  return path + "holding, stopped";
}

std::string KindOf(const std::string& fault) { return fault.substr(0, fault.find('@')); }

/// What came of a run with a fault.
struct Outcome {
  ArmRun run;
  std::string cause, path;
  double at_rest = 0;           ///< since the fault [s]
  double moved = 0;             ///< of any joint, since the fault [rad]
  double speed = 0;             ///< the largest at the fault [rad/s]
  bool is_handed_back = false;  ///< whatever handing_back says
};

bool Within(const PerJoint& x, const PerJoint& limit) {
  return x.allFinite() && (x.array().abs() <= limit.array() + 1e-5).all();  // single precision
}

/// What is recorded is complete, finite and within the limits.
void ReadLog(Outcome& out, const ExperimentFile& file) {
  const Recording log = Recording::Read(out.run.log);
  const RecordedSignal& report = log["safety.report"];
  std::string last;
  for (const double s : report[".state"]) {
    const std::string state = WordOf(static_cast<SafetyState>(s));
    if (state != std::exchange(last, state)) out.path += (out.path.empty() ? "" : ", ") + state;
  }
  const Eigen::Index end = report.numbers.cols() - 1;
  EXPECT_EQ(end + 1, out.run.timing.ticks) << "a row for each tick";
  out.cause = WordOf(static_cast<SafetyCause>(report[".cause"](end)));
  EXPECT_EQ(log.metadata().at("pliant.run").at("end"), out.run.text());

  const SimulatedArm::Options arm = StationOf(file.scenarios.front());
  const std::map<std::string, PerJoint> limits{
      {"safety.arm_torque", arm.model.effort_limit()},
      {"safety.arm_current", FiguresOf(arm.actuators.joint, &ActuatorParameters::current_limit)}};
  for (const auto& [path, limit] : limits)
    for (Eigen::Index k = 0; k <= end; ++k)
      EXPECT_TRUE(Within(log[path].numbers.col(k), limit)) << path << ", row " << k;
}

/// What the arm received and did; the run made the first `ran` steps.
void WatchArm(Outcome& out, const std::vector<Gen3Moment>& moments, std::size_t ran,
              const ExperimentFile& file) {
  const SimulatedArm::Options arm = StationOf(file.scenarios.front());
  const PerJoint i_max = FiguresOf(arm.actuators.joint, &ActuatorParameters::current_limit);
  const Gen3Moment* begin = nullptr;
  for (std::size_t k = 1; k < moments.size(); ++k) {
    const Gen3Moment& m = moments[k];
    EXPECT_TRUE(Within(m.torque, arm.model.effort_limit())) << "received at " << m.t << " s";
    EXPECT_TRUE(Within(m.current, i_max)) << "received at " << m.t << " s";
    if (m.t < kFault) continue;
    if (!begin) begin = &m;
    const double v = m.velocity.cwiseAbs().maxCoeff();
    if (begin == &m) out.speed = v;
    out.moved = std::max(out.moved, (m.position - begin->position).cwiseAbs().maxCoeff());
    // An arm that takes over settles on its own gains.
    const bool rests = v <= SafetySupervisor::Settings().rest_speed;
    if (!rests && (k <= ran || out.at_rest == moments[k - 1].t - kFault))
      out.at_rest = m.t - kFault;
  }
}

/// Runs a circling arm that meets a fault, and watches it for half a second more.
Outcome RunWith(const std::string& fault, ControlMode mode) {
  const TemporaryDirectory folder;
  const std::string kind = KindOf(fault);
  const auto ours = CommandFaults::Kinds();
  const bool is_ours =
      std::ranges::any_of(ours, [&](const FaultOrder::Kind& k) { return k.name == kind; });
  const bool is_none = kind == "user_stop" || kind == "none";
  LockStepGen3 gen3(is_ours || is_none ? std::vector<std::string>{} : std::vector{fault});
  ArmRunOptions o{.out = folder.path(), .connect = gen3.connect()};
  if (is_ours) o.faults = {FaultOrder::Of(fault, ours)};
  gen3.at = [&gen3, kind, panel = o.panel](double t) {
    if (kind == "user_stop" && t >= kFault) panel->stop = true;
    // Who keeps the connection alive notices by the wall clock.
    if (kind == "tcp_reset" && t >= kFault + 0.0015 && t < kFault + 0.0025) gen3.AwaitLoss();
  };
  const auto file = ExperimentFile::ReadText(
      CirclingArm(mode, OnArm(gen3.address()),
                  "safety: {hold_s: 0.5}\nduration_s: " + Text(kDuration) + "\n"),
      "circling.yaml");
  Outcome out;
  out.run = RunOnArm(file, o);
  const std::size_t ran = gen3.moments().size();
  const auto link = ConnectGen3(Gen3Address::Of(gen3.address()));
  out.is_handed_back = link->Servoing() == Gen3Servoing::SingleLevel;
  for (int j = 0; j < kGen3Joints; ++j)
    out.is_handed_back = out.is_handed_back && link->Mode(j) == Gen3Mode::Position;
  Gen3Feedback feedback;
  for (int k = 0; k < 500; ++k) {
    link->Send({});  // moves time alone: it does not act
    link->Receive(feedback, std::chrono::milliseconds(5));
  }
  EXPECT_EQ(gen3.failure(), "");
  ReadLog(out, file);
  WatchArm(out, gen3.moments(), ran, file);
  return out;
}

/// How long the arm may move after a fault, and how far, from its speed v at the fault:
///
///   t ≤ t_found + t_damped + v/a + t_own
///   |Δq| ≤ v (t_found + t_own + T) + v²/(2 a) + what the fault itself moves
///
/// Found within 71 ms: frozen_after and stale_after, and most_missed ticks, are less. Position
/// control stops with the deceleration a; the joints' own loops lag behind it by t_own < 0.1 s, ten
/// times what they do in the firmware's model. Damped, a joint comes to rest as e^(−t/T),
/// T = (M + B)/D, friction and coupling apart.
struct Bounds {
  double time, angle;
};
Bounds BoundsOf(const Row& row, ControlMode mode, double speed) {
  constexpr double kFound = 0.071, kOwn = 0.1;
  const SafetySupervisor::Settings s;
  const auto file =
      ExperimentFile::ReadText(CirclingArm(mode, "!SimulatedArm {}", "duration_s: 1\n"), "a");
  const SimulatedArm::Options arm = StationOf(file.scenarios.front());
  RobotDynamics d(arm.model);
  ComputeDynamics(arm.model, arm.position, JointVelocity::Zero(arm.model.joints()), d);
  const PerJoint M = d.M.diagonal();
  const PerJoint D = PerJoint(0.08 * arm.model.effort_limit()).cwiseMin(100 * M);
  const double T = (M + arm.actuators.reflected_inertia()).cwiseQuotient(D).maxCoeff();
  const double v = speed;
  double by_fault = 0;
  if (KindOf(row.fault) == "encoder_jump") by_fault = 2 * std::numbers::pi / 180;
  return {kFound + s.damped_s + v / s.deceleration + kOwn,
          v * (kFound + kOwn + T) + v * v / (2 * s.deceleration) + by_fault};
}

// The document.

std::string Fixed(double x, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, x);
  return text;
}

/// Whether a silent arm counts as lost before it is handed back depends on how long that takes.
bool IsByTheWallClock(const Row& row) {
  return KindOf(row.fault) == "silent" && row.then == Then::Holds;
}

std::string LineOf(const Row& row, const Outcome& o) {
  const bool stops = row.then == Then::Holds || row.then == Then::Damps;
  const double degrees = 180 / std::numbers::pi;
  return "| `" + std::string(row.fault) + "` | " + (row.then == Then::GoesOn ? "none" : o.cause) +
         " | " + (row.then == Then::GoesOn ? "goes on" : o.path) + " | " +
         (stops ? Fixed(o.at_rest, 2) + " s | " + Fixed(degrees * o.moved, 1) + "°" : "– | –") +
         " | " +
         (IsByTheWallClock(row)        ? "one way or the other"
          : o.run.handing_back.empty() ? "yes"
                                       : "by another connection") +
         " |\n";
}

constexpr const char* kDocument = PLIANT_SOURCE_DIR "/docs/fault-matrix.md";
constexpr const char* kHead =
    "| fault | cause | states | at rest after | moved | handed back |\n|---|---|---|---|---|---|\n";

/// Words are the same; numbers may be one off in the last digit, where a compiler rounds otherwise.
bool IsSameLine(const std::string& a, const std::string& b) {
  const auto parted = [](const std::string& line) {
    std::pair<std::string, std::vector<double>> parts;
    for (std::size_t i = 0; i < line.size();) {
      const bool number = line.compare(i, 2, "| ") == 0 && i + 2 < line.size() &&
                          std::isdigit(static_cast<unsigned char>(line[i + 2])) != 0;
      if (!number) {
        parts.first += line[i++];
        continue;
      }
      std::size_t length = 0;
      parts.second.push_back(std::stod(line.substr(i + 2), &length));
      i += 2 + length;
    }
    return parts;
  };
  const auto x = parted(a), y = parted(b);
  if (x.first != y.first || x.second.size() != y.second.size()) return false;
  for (std::size_t i = 0; i < x.second.size(); ++i)
    if (std::abs(x.second[i] - y.second[i]) > (i == 0 ? 0.011 : 0.11)) return false;
  return true;
}

/// A machine that stands still for a second lets the connection of the run be too slow to hand the
/// arm back, and another one does it.
std::string ByItsOwn(std::string line) {
  constexpr std::string_view kOther = "| by another connection |";
  if (const std::size_t at = line.rfind(kOther); at != line.npos)
    line.replace(at, kOther.size(), "| yes |");
  return line;
}

/// With PLIANT_WRITE_DOCUMENTS it becomes what was measured.
void HoldAgainstTheDocument(ControlMode mode, const std::vector<std::string>& lines) {
  std::string text = ReadText(kDocument);
  const std::string mark = "<!-- measured: " + WordOf(mode) + " -->\n";
  const std::size_t begin = text.find(mark), end = text.find("<!-- end -->", begin);
  ASSERT_NE(end, std::string::npos) << kDocument << " lacks " << mark;
  const std::size_t from = begin + mark.size();
  if (std::getenv("PLIANT_WRITE_DOCUMENTS")) {
    std::string measured = std::string("\n") + kHead;
    for (const std::string& line : lines) measured += line;
    text.replace(from, end - from, measured + "\n");
    std::ofstream(kDocument) << text;
    return;
  }
  std::istringstream stated(text.substr(from, end - from));
  std::vector<std::string> rows;
  for (std::string line; std::getline(stated, line);)
    if (line.starts_with("| `")) rows.push_back(line + "\n");
  ASSERT_EQ(rows.size(), lines.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_TRUE(IsSameLine(rows[i], lines[i]) || IsSameLine(rows[i], ByItsOwn(lines[i])))
        << "stated:   " << rows[i] << "measured: " << lines[i];
}

class FaultMatrix : public testing::TestWithParam<ControlMode> {};

TEST_P(FaultMatrix, IsAsTheTableSays) {
  const ControlMode mode = GetParam();
  std::vector<std::string> lines;
  for (const Row& row : kMatrix) {
    SCOPED_TRACE(std::string(row.fault) + ", " + WordOf(mode));
    const Outcome o = RunWith(row.fault, mode);
    EXPECT_THAT(o.cause, StrEq(row.cause));
    EXPECT_THAT(o.path, StrEq(PathOf(row, mode)));
    EXPECT_TRUE(o.is_handed_back) << o.run.handing_back;
    EXPECT_EQ(o.run.whole, row.then == Then::GoesOn);
    if (row.then == Then::Holds || row.then == Then::Damps) {
      EXPECT_GT(o.speed, 0.1) << "the arm moved";
      const Bounds bounds = BoundsOf(row, mode, o.speed);
      EXPECT_LE(o.at_rest, bounds.time);
      EXPECT_LE(o.moved, bounds.angle);
    }
    lines.push_back(LineOf(row, o));
    std::printf("%s", lines.back().c_str());
    std::fflush(stdout);
  }
  HoldAgainstTheDocument(mode, lines);
}

INSTANTIATE_TEST_SUITE_P(All, FaultMatrix,
                         testing::Values(ControlMode::Position, ControlMode::Torque,
                                         ControlMode::TorqueHighVelocity, ControlMode::Current),
                         [](const auto& of) { return WordOf(of.param); });

}  // namespace
}  // namespace pliant
