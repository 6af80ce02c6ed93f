#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/apps/doctor_checks.h"

namespace pliant {
namespace {

using ::testing::AllOf;
using ::testing::Each;
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

TEST(Doctor, NeedsGnuplotAndTheSharedFiles) {
  EXPECT_EQ(CheckGnuplot("it runs", "").verdict, Verdict::Ok);
  EXPECT_EQ(CheckGnuplot("", "not found").text(),
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

TEST(Doctor, NeedsTheArmOnlyIfOneWasNamed) {
  EXPECT_EQ(CheckArm({}).verdict, Verdict::Note);
  EXPECT_THAT(CheckArm({}).way_out, HasSubstr("192.168.1.10"));
  EXPECT_EQ(CheckArm(ArmFacts{"192.168.1.10:10000", "", 0.0005}).text(),
            "ok       arm               192.168.1.10:10000 answered in 500 us by TCP; the 1 kHz "
            "exchange by UDP was not tried");
  const Finding silent = CheckArm(ArmFacts{"192.168.1.10:10000", "Connection timed out", 2});
  EXPECT_EQ(silent.verdict, Verdict::Missing);
  EXPECT_EQ(silent.found, "192.168.1.10:10000: Connection timed out");
}

}  // namespace
}  // namespace pliant
