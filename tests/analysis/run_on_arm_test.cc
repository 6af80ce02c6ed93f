#include "pliant/analysis/run_on_arm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <stop_token>
#include <thread>

#include "pliant/analysis/recording.h"
#include "pliant/analysis/replay.h"
#include "pliant/analysis/run_data.h"
#include "pliant/diagrams/rdt_emulator.h"
#include "pliant/plants/shared_file.h"
#include "pliant/tests/analysis/lock_step_gen3.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr ControlMode kModes[] = {ControlMode::Position, ControlMode::Torque,
                                  ControlMode::TorqueHighVelocity, ControlMode::Current};
constexpr const char* kShort = "duration_s: 0.8\n";

/// A run of a circling arm, or of another, in a folder of its own.
struct Ran {
  explicit Ran(ControlMode mode, LockStepGen3& gen3)
      : Ran(CirclingArm(mode, OnArm(gen3.address()), kShort), gen3) {}
  Ran(const std::string& text, LockStepGen3& gen3)
      : file{ExperimentFile::ReadText(text, "arm.yaml")},
        run{RunOnArm(file, {.out = folder.path(), .connect = gen3.connect()})},
        log{Recording::Read(run.log)} {}

  /// As `pliant replay` has it: the log says what was run.
  ReplayResult ReplayOf(const std::string& part) const {
    const RunData data = RunData::Read(run.log);
    return Replay(std::move(ScenarioDiagram(data.scenario).builder), part, data.log);
  }

  TemporaryDirectory folder;
  ExperimentFile file;
  ArmRun run;
  Recording log;
};

bool IsHandedBack(const LockStepGen3& gen3) {
  const auto link = ConnectGen3(Gen3Address::Of(gen3.address()));
  bool back = link->Servoing() == Gen3Servoing::SingleLevel;
  for (int j = 0; j < kGen3Joints; ++j) back = back && link->Mode(j) == Gen3Mode::Position;
  return back;
}

class RunOnArmInMode : public testing::TestWithParam<ControlMode> {};

TEST_P(RunOnArmInMode, EndsWholeAndHandsTheArmBack) {
  LockStepGen3 gen3;
  const Ran r(GetParam(), gen3);
  EXPECT_TRUE(r.run.whole) << r.run.text();
  EXPECT_EQ(r.run.safety.cause, SafetyCause::UserStop);
  EXPECT_EQ(r.run.handing_back, "");
  EXPECT_EQ(r.run.services, "");
  EXPECT_TRUE(IsHandedBack(gen3));
  EXPECT_EQ(r.log["safety.report"].numbers.cols(), r.run.timing.ticks) << "a row for each tick";
  EXPECT_EQ(r.run.arm.answered, r.run.arm.sent)
      << "all commands but the last are seen to be answered";
  EXPECT_EQ(r.log.metadata().at("pliant.run").at("whole"), "1");
}

TEST_P(RunOnArmInMode, IsReplayedBitForBit) {
  LockStepGen3 gen3;
  const Ran r(GetParam(), gen3);
  for (const char* part : {"control", "safety"}) {
    const ReplayResult result = r.ReplayOf(part);
    EXPECT_TRUE(result.identical()) << part << ": " << result.text();
    EXPECT_GT(result.rows, 800u);
  }
}

TEST_P(RunOnArmInMode, IsTheSameBitForBitOnAnEqualArm) {
  LockStepGen3 one, other;
  const Ran a(GetParam(), one), b(GetParam(), other);
  ASSERT_EQ(a.log.signals().size(), b.log.signals().size());
  for (const RecordedSignal& signal : a.log.signals()) {
    if (signal.path == "timer.timing") continue;  // of this machine
    EXPECT_EQ(signal.times, b.log[signal.path].times) << signal.path;
    EXPECT_EQ(signal.numbers, b.log[signal.path].numbers) << signal.path;
  }
}

/// The wire has the turn of a joint in single precision, the rest of the way is the same: what the
/// arm is told is what the supervisor said a tick before, rounded.
TEST_P(RunOnArmInMode, BringsTheSupervisorsCommandsToTheArmInSinglePrecision) {
  LockStepGen3 gen3;
  const Ran r(GetParam(), gen3);
  const auto moments = gen3.moments();
  const RecordedSignal& torque = r.log["safety.arm_torque"];
  const RecordedSignal& current = r.log["safety.arm_current"];
  const bool torques =
      GetParam() == ControlMode::Torque || GetParam() == ControlMode::TorqueHighVelocity;
  const bool currents = GetParam() == ControlMode::Current;
  const auto first = std::ranges::find_if(moments, [](const auto& m) { return m.t > 0; });
  ASSERT_NE(first, moments.end());
  for (Eigen::Index k = 10; k < 700; ++k) {  // all joints are in the mode, and nobody has stopped
    const Gen3Moment& m = *(first + k);
    constexpr double kRounding = 6e-8;  // 2⁻²⁴ of the number
    const auto expect = [](const auto& received, const Eigen::VectorXd& said) {
      EXPECT_LE((received - said).cwiseAbs().maxCoeff(), kRounding * said.cwiseAbs().maxCoeff());
    };
    if (torques) expect(m.torque, torque.numbers.col(k));
    if (currents) expect(m.current, current.numbers.col(k));
  }
}

INSTANTIATE_TEST_SUITE_P(All, RunOnArmInMode, testing::ValuesIn(kModes),
                         [](const auto& of) { return WordOf(of.param); });

TEST(RunOnArm, TurnsAJointOnThroughHalfATurn) {
  // Joint 1 begins 0.05 rad before 180°; the tool goes round the base's axis.
  constexpr double kPi = std::numbers::pi;
  for (const ControlMode mode : kModes) {
    Gen3Body::Options arm;
    arm.station.position = {kPi - 0.05, 0.2618, kPi, -2.2689, 0, 0.9599, kPi / 2};
    LockStepGen3 gen3({}, arm);
    std::string text = CirclingArm(mode, OnArm(gen3.address()), "duration_s: 2.5\n");
    const std::string circle =
        "!Circle {center: [0, 0.05, 0], normal: [1, 0, 0], speed: 2, rise_s: 0.5}";
    // The tool is at x = −0.45 m: +y is on through 180°, as the axis points down.
    text.replace(text.find(circle), circle.size(),
                 "!Waypoints {waypoints: [{time_s: 0.2, position: [0, 0, 0]}, "
                 "{time_s: 2.2, position: [0, 0.1, 0]}]}");
    const Ran r(text, gen3);
    EXPECT_TRUE(r.run.whole) << r.run.text();
    const Eigen::VectorXd q = r.log["arm.measured_position"].numbers.row(0);
    EXPECT_NEAR(q(0), kPi - 0.05, 1e-3);
    EXPECT_GT(q(q.size() - 1), kPi + 0.05) << "on, beyond half a turn";
    const double step = (q.tail(q.size() - 1) - q.head(q.size() - 1)).cwiseAbs().maxCoeff();
    EXPECT_LT(step, 1.4e-3) << "no faster than the joint may be";
    EXPECT_NEAR(gen3.moments().back().position(0), q(q.size() - 1), 2e-3) << "the plant's own";
  }
}

// What a run needs.

std::string RefusalOf(const std::string& text, const ArmRunOptions& o) {
  return ErrorOf([&] { RunOnArm(ExperimentFile::ReadText(text, "arm.yaml"), o); });
}
std::string HeldArm(const std::string& station, const std::string& more = kShort,
                    const std::string& robot = "gen3", const std::string& control = "") {
  return "title: An arm\nsummary: Of a test.\nrobot: " + robot + "\nstation: " + station +
         "\ncontroller: !Compliance {tool: tool_frame" + control + "}\n" + more;
}

TEST(RunOnArm, LogsWhatItsBlocksAreEstimatedToCost) {
  LockStepGen3 gen3;
  const Ran r(ControlMode::Torque, gen3);
  const auto& costs = r.log.metadata().at("pliant.costs");
  ASSERT_TRUE(costs.contains("control.qp"));
  EXPECT_GT(std::stod(costs.at("control.qp")), 0);
}

TEST(RunOnArm, NeedsAStationThatIsAnArm) {
  const TemporaryDirectory folder;
  EXPECT_EQ(RefusalOf(HeldArm("!SimulatedArm {}"), {.out = folder.path()}),
            "station must be !Gen3 to run an arm; give --arm ADDRESS");
}

TEST(RunOnArm, DoesOneRunAtATime) {
  const TemporaryDirectory folder;
  const std::string one = "an arm does one run at a time; name one with --run, and --repeat 1";
  const std::string runs = "runs: [{name: a, title: a}, {name: b, title: b}]\n";
  EXPECT_EQ(RefusalOf(HeldArm("!Gen3 {}", kShort + runs), {.out = folder.path()}), one);
  EXPECT_EQ(
      RefusalOf(HeldArm("!Gen3 {}", kShort + std::string("repeat: 2\n")), {.out = folder.path()}),
      one);
}

TEST(RunOnArm, RecordsEachTick) {
  const TemporaryDirectory folder;
  EXPECT_EQ(RefusalOf(HeldArm("!Gen3 {}", kShort + std::string("log_period: 2 ms\n")),
                      {.out = folder.path()}),
            "log_period must be the controller's period on an arm; leave it out");
}

TEST(RunOnArm, DoesNotWriteOverALog) {
  const TemporaryDirectory folder;
  LockStepGen3 gen3;
  const std::string text = HeldArm(OnArm(gen3.address()));
  const ArmRunOptions o{.out = folder.path(), .connect = gen3.connect()};
  EXPECT_EQ(RefusalOf(text, o), "no error");
  EXPECT_EQ(RefusalOf(text, o), (folder.path() / "logs/run.mcap").string() +
                                    " exists; give --force to write over it, or another --out");
  EXPECT_EQ(gen3.counts().commands, gen3.counts().ticks) << "the arm was not asked";
  ArmRunOptions over = o;
  over.force = true;
  EXPECT_EQ(RefusalOf(text, over), "no error");
}

TEST(RunOnArm, RefusesWhatOnlyASimulationHas) {
  const auto refusal = [](const std::string& text) {
    return ErrorOf([&] { ExperimentFile::ReadText(text, "arm.yaml"); });
  };
  const std::string is = "station !Gen3 is an arm that is there: ";
  const std::string gen3 = "!Gen3 {}";
  EXPECT_THAT(refusal(HeldArm(gen3, kShort, "lwr")),
              HasSubstr(is + "expected robot gen3 or gen3_bota, got 'lwr'"));
  EXPECT_THAT(refusal(HeldArm(
                  gen3, kShort + std::string("environment:\n  - !Push {link: tool_frame, force: "
                                             "[0, 1, 0], start_s: 0.1, duration_s: 0.1, "
                                             "edge_s: 0.01}\n"))),
              HasSubstr(is + "it has its own environment; leave environment out"));
  EXPECT_THAT(
      refusal(HeldArm(gen3, kShort + std::string("payload: {link: tool_frame, mass: 1 kg}\n"))),
      HasSubstr(is + "it has its own payload; leave payload out"));
  EXPECT_THAT(refusal(HeldArm(gen3, kShort + std::string("position_scatter: 0.1\n"))),
              HasSubstr(is + "it starts where it is; leave position_scatter out"));
  EXPECT_THAT(refusal(HeldArm(gen3, kShort, "gen3", ", estimate: true")),
              HasSubstr(is + "nobody knows the true torques"));
}

TEST(RunOnArm, SaysThatThereIsNoArm) {
  const TemporaryDirectory folder;
  const std::string nobody = LockStepGen3().address();
  EXPECT_THAT(RefusalOf(HeldArm(OnArm(nobody)), {.out = folder.path()}),
              StartsWith("cannot reach an arm at 127.0.0.1:"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "logs/run.mcap"));
}

TEST(RunOnArm, SaysThatItWasNotLetIn) {
  const TemporaryDirectory folder;
  const Gen3Emulator gen3({.password = "another", .lock_step = true});
  const std::string at =
      "127.0.0.1:" + std::to_string(gen3.port()) + "," + std::to_string(gen3.udp_port());
  EXPECT_THAT(RefusalOf(HeldArm(OnArm(at)), {.out = folder.path()}), HasSubstr("INVALID_PASSWORD"));
}

TEST(RunOnArm, DoesNotRunAnArmInFault) {
  const TemporaryDirectory folder;
  LockStepGen3 gen3({"emergency_stop@0.3+0.1"});
  const std::string text = HeldArm(OnArm(gen3.address()));
  ArmRunOptions o{.out = folder.path() / "first", .connect = gen3.connect()};
  EXPECT_EQ(RefusalOf(text, o), "no error");
  o.out = folder.path() / "second";
  EXPECT_THAT(RefusalOf(text, o), StartsWith("the arm is in fault and takes no commands\n"));
  o.out = folder.path() / "third";
  EXPECT_EQ(RefusalOf(HeldArm(OnArm(gen3.address(), ", clear_faults: true")), o), "no error");
}

// A wrist sensor of its own.

/// Shows the weight of what hangs on it, and an offset: by the wall clock until the arm moves, and
/// then in its steps until a time.
struct WristOn {
  explicit WristOn(LockStepGen3& gen3, double until_s) : sensor{{.port = 0}} {
    gen3.at = [this, until_s](double t) {
      if (before.joinable()) {
        before.request_stop();
        before.join();
      }
      if (t < until_s) sensor.Tick(wrench);
    };
    before = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        sensor.Tick(wrench);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }
  const Wrench wrench{0.1, -0.2, 0.05, 3, -4, 5};
  RdtEmulator sensor;
  std::jthread before;
};

std::string FusingArm(const std::string& address, int port) {
  return HeldArm(
      OnArm(address, ", wrist: !Rdt {host: 127.0.0.1, port: " + std::to_string(port) + "}"),
      "duration_s: 1.2\n", "gen3_bota", ", estimate: fusion");
}

TEST(RunOnArm, GoesOnByTheJointsWhenTheWristSensorFallsSilent) {
  Gen3Body::Options arm;
  arm.model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof_bota.urdf"));
  LockStepGen3 gen3({}, arm);
  WristOn wrist(gen3, 0.8);
  const Ran r(FusingArm(gen3.address(), wrist.sensor.port()), gen3);
  EXPECT_TRUE(r.run.whole) << r.run.text();
  const RecordedSignal& valid = r.log["arm.wrench_valid"];
  const auto at = [&](double t) { return valid.numbers(0, static_cast<Eigen::Index>(1000 * t)); };
  EXPECT_EQ(at(0.1), 1);
  EXPECT_EQ(at(0.79), 1);
  EXPECT_EQ(at(0.82), 0) << "10 ms without a measurement";
  EXPECT_EQ(valid.numbers(0, valid.numbers.cols() - 1), 0);
  EXPECT_TRUE(r.log["control.external_torque"].numbers.allFinite());
}

TEST(RunOnArm, NeedsAWristSensorThatMeasures) {
  const TemporaryDirectory folder;
  LockStepGen3 gen3;
  const RdtEmulator silent({.port = 0});
  EXPECT_EQ(RefusalOf(FusingArm(gen3.address(), silent.port()), {.out = folder.path()}),
            "the wrist sensor must measure 200 times before the start, for its offset; got 0 in 3 "
            "s\nsee that it is on, and what station.wrist says");
}

}  // namespace
}  // namespace pliant
