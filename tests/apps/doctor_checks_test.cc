#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/apps/doctor_checks.h"

namespace pliant {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A machine made for an arm.
RealTimeFacts Good() {
  return {.user = "ann",
          .fifo_fault = "",
          .rtprio = 95,
          .memory_fault = "",
          .memlock = UINT64_MAX,
          .preempt_rt = true,
          .kernel = "6.1.0-rt",
          .governor = "performance",
          .processors = 4,
          .isolated = "3",
          .clock = "tsc",
          .median_s = 5e-6,
          .worst_s = 40e-6};
}

Finding Of(const RealTimeFacts& facts, bool for_arm, const std::string& subject) {
  for (Finding& finding : CheckRealTime(facts, for_arm))
    if (finding.subject == subject) return finding;
  ADD_FAILURE() << "no finding on " << subject;
  return {};
}

TEST(Doctor, WritesALineWithTheWayOutBehindWhatWasFound) {
  EXPECT_EQ((Finding{Verdict::Missing, "gnuplot", "not found", "install it"}.text()),
            "missing  gnuplot           not found; install it");
  EXPECT_EQ((Finding{Verdict::Ok, "clock", "tsc"}.text()), "ok       clock             tsc");
}

TEST(Doctor, FindsNothingOnAMachineMadeForAnArm) {
  EXPECT_THAT(CheckRealTime(Good(), true),
              Each(AllOf(Field(&Finding::verdict, Verdict::Ok), Field(&Finding::way_out, ""))));
}

TEST(Doctor, NeedsNothingOfRealTimeToSimulate) {
  const RealTimeFacts bad{.user = "ann",
                          .fifo_fault = "Operation not permitted",
                          .rtprio = 0,
                          .memory_fault = "Cannot allocate memory",
                          .memlock = 8388608,
                          .preempt_rt = false,
                          .kernel = "6.1.0",
                          .governor = "powersave",
                          .processors = 1,
                          .isolated = "",
                          .clock = "hpet",
                          .median_s = 1e-3,
                          .worst_s = 20e-3};
  EXPECT_THAT(CheckRealTime(bad, false), Each(Field(&Finding::verdict, Verdict::Note)));
  EXPECT_THAT(CheckRealTime(bad, false), Each(Field(&Finding::way_out, ::testing::Ne(""))));
}

TEST(Doctor, NeedsSchedulingForAnArm) {
  RealTimeFacts facts = Good();
  facts.fifo_fault = "Operation not permitted";
  facts.rtprio = 0;
  const Finding finding = Of(facts, true, "SCHED_FIFO");
  EXPECT_EQ(finding.verdict, Verdict::Missing);
  EXPECT_EQ(finding.found, "Operation not permitted, priorities up to 0");
  EXPECT_THAT(finding.way_out,
              AllOf(StartsWith("put \"ann - rtprio 95\" into /etc/security/limits"),
                    HasSubstr("\"@realtime - rtprio 95\""), EndsWith("then log in anew")));
}

TEST(Doctor, NeedsLockedMemoryForAnArm) {
  RealTimeFacts facts = Good();
  facts.memory_fault = "Cannot allocate memory";
  facts.memlock = 8388608;
  const Finding finding = Of(facts, true, "locked memory");
  EXPECT_EQ(finding.verdict, Verdict::Missing);
  EXPECT_EQ(finding.found, "Cannot allocate memory, up to 8 MB");
  EXPECT_THAT(finding.way_out, HasSubstr("\"ann - memlock unlimited\""));
}

TEST(Doctor, NeedsWakingInTimeForAnArm) {
  RealTimeFacts facts = Good();
  facts.worst_s = kLatestWake;
  EXPECT_EQ(Of(facts, true, "waking").verdict, Verdict::Ok);
  facts.worst_s = 201e-6;
  const Finding finding = Of(facts, true, "waking");
  EXPECT_EQ(finding.verdict, Verdict::Missing);
  EXPECT_EQ(finding.found, "late by 5 us in the middle, 201 us at worst, of 500 times");
  EXPECT_EQ(finding.way_out, "expected at most 200 us; see the notes below, and what else runs");
  facts.fifo_fault = "Operation not permitted";
  EXPECT_THAT(Of(facts, true, "waking").text(), EndsWith("without SCHED_FIFO; expected at most "
                                                         "200 us; see SCHED_FIFO"));
}

TEST(Doctor, NotesWhatMayMakeAThreadLate) {
  RealTimeFacts facts = Good();
  facts.preempt_rt = false;
  facts.governor = "powersave";
  facts.isolated = "";
  facts.clock = "acpi_pm";
  for (const char* subject : {"kernel", "frequency", "processors", "clock"})
    EXPECT_EQ(Of(facts, true, subject).verdict, Verdict::Note) << subject;
  EXPECT_EQ(Of(facts, true, "kernel").found, "6.1.0-rt, not PREEMPT_RT");
  EXPECT_EQ(Of(facts, true, "frequency").found, "governor powersave");
  EXPECT_EQ(Of(facts, true, "processors").found, "4, none isolated");
  EXPECT_THAT(Of(facts, true, "processors").way_out, StartsWith("isolcpus=3 "));
}

TEST(Doctor, TakesAFrequencyThatNobodyChangesForSteady) {
  RealTimeFacts facts = Good();
  facts.governor = "";
  EXPECT_EQ(Of(facts, true, "frequency").verdict, Verdict::Ok);
}

TEST(Doctor, NeedsProgramsThatDrawAndTheSharedFiles) {
  EXPECT_EQ(CheckProgram("gnuplot", "gnuplot-nox", "").verdict, Verdict::Ok);
  EXPECT_EQ(CheckProgram("gnuplot", "gnuplot-nox", "not found").text(),
            "missing  gnuplot           not found; install the Debian package gnuplot-nox, or put "
            "gnuplot's folder on PATH");
  EXPECT_EQ(CheckShared({"models", "/usr/share/pliant/models", ""}).verdict, Verdict::Ok);
  EXPECT_EQ(CheckShared({"models", "", "there is no 'models'"}).text(),
            "missing  models            there is no 'models'; install pliant anew, or set "
            "PLIANT_SHARE to the folder that has it");
}

TEST(Doctor, NeedsAFolderThatCanBeWrittenToAndHasRoom) {
  EXPECT_EQ(CheckOutput({"/data", "", 5'000'000'000}).text(),
            "ok       output            /data, 5 GB free");
  EXPECT_EQ(CheckOutput({"/data", "", 999'000'000}).verdict, Verdict::Note);
  EXPECT_EQ(CheckOutput({"/data", "", 99'000'000}).verdict, Verdict::Missing);
  EXPECT_EQ(CheckOutput({"/data", "Permission denied", 0}).text(),
            "missing  output            /data cannot be written to: Permission denied; go to "
            "another folder, or give one with --out");
}

std::vector<std::string> Texts(const ArmFacts& facts) {
  std::vector<std::string> texts;
  for (const Finding& finding : CheckArm(facts)) texts.push_back(finding.text());
  return texts;
}

/// An arm of one joint, that is well.
ArmFacts GoodArm() {
  return {
      .address = "192.168.1.10:10000",
      .answered_s = 0.0005,
      .state = "ARMSTATE_SERVOING_READY",
      .servoing = "SINGLE_LEVEL_SERVOING",
      .joints = {{.torques = 299, .motor_temperature = 31, .core_temperature = 36, .faults = {}}}};
}

TEST(Doctor, NeedsTheArmOnlyIfOneWasNamed) {
  EXPECT_EQ(CheckArm({}).at(0).verdict, Verdict::Note);
  EXPECT_THAT(CheckArm({}).at(0).way_out, HasSubstr("192.168.1.10"));
  const Finding silent =
      CheckArm(ArmFacts{.address = "192.168.1.10:10000", .fault = "Connection timed out"}).at(0);
  EXPECT_EQ(silent.verdict, Verdict::Missing);
  EXPECT_EQ(silent.found, "192.168.1.10:10000: Connection timed out");
}

TEST(Doctor, FindsNothingOnAnArmThatIsWell) {
  EXPECT_THAT(
      Texts(GoodArm()),
      ElementsAre("ok       arm               192.168.1.10:10000 answered in 500 us by TCP",
                  "ok       arm state         ARMSTATE_SERVOING_READY, SINGLE_LEVEL_SERVOING",
                  "ok       arm joint 1       299 different torques of 300, motor 31 C, core "
                  "36 C"));
}

TEST(Doctor, NeedsASessionWithTheArm) {
  const std::vector<std::string> texts =
      Texts({.address = "a:1", .answered_s = 1e-3, .session_fault = "a:1 refused CreateSession"});
  EXPECT_THAT(texts, ElementsAre("ok       arm               a:1 answered in 1000 us by TCP",
                                 "missing  arm session       a:1 refused CreateSession"));
}

TEST(Doctor, NeedsAnArmWithoutFaults) {
  ArmFacts facts = GoodArm();
  facts.state = "ARMSTATE_IN_FAULT";
  EXPECT_THAT(Texts(facts).at(1),
              AllOf(StartsWith("missing  arm state"), HasSubstr("recover gen3 --clear-faults")));
  facts = GoodArm();
  facts.faults = {"JOINT_FAULT", "NETWORK_ERROR"};
  EXPECT_THAT(Texts(facts).at(1),
              AllOf(StartsWith("missing  arm state"), HasSubstr(", JOINT_FAULT, NETWORK_ERROR;")));
  facts = GoodArm();
  facts.joints[0].faults = {"FOLLOWING_ERROR"};
  EXPECT_THAT(Texts(facts).at(2),
              AllOf(StartsWith("missing  arm joint 1"), HasSubstr("core 36 C, FOLLOWING_ERROR;")));
}

TEST(Doctor, NotesAnArmThatWasLeftInLowLevelServoing) {
  ArmFacts facts = GoodArm();
  facts.servoing = "LOW_LEVEL_SERVOING";
  facts.left_low_level = true;
  EXPECT_THAT(Texts(facts).at(1),
              AllOf(StartsWith("note     arm state"), HasSubstr("`pliant recover gen3`")));
}

TEST(Doctor, TellsADeadTorqueSensorFromOneWithNoise) {
  ArmFacts facts = GoodArm();
  facts.joints[0].torques = 1;
  EXPECT_THAT(Texts(facts).at(2),
              AllOf(StartsWith("missing  arm joint 1       1 different torques"),
                    HasSubstr("its torque sensor is dead")));
  facts.joints[0].torques = 149;
  EXPECT_THAT(Texts(facts).at(2), StartsWith("note     arm joint 1"));
  facts.joints[0].torques = 150;
  EXPECT_THAT(Texts(facts).at(2), StartsWith("ok       arm joint 1"));
}

}  // namespace
}  // namespace pliant
