#include "pliant/apps/doctor_checks.h"

#include <cstdio>
#include <string_view>

namespace pliant {

namespace {

constexpr std::uint64_t kGigabyte = 1'000'000'000;

std::string Micro(double s) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f us", 1e6 * s);
  return text;
}

std::string Size(std::uint64_t bytes) {
  if (bytes == UINT64_MAX) return "unlimited";
  char text[32];
  const double number = static_cast<double>(bytes);
  if (bytes >= kGigabyte)
    std::snprintf(text, sizeof text, "%.0f GB", 1e-9 * number);
  else
    std::snprintf(text, sizeof text, "%.0f MB", 1e-6 * number);
  return text;
}

/// What gives a user a limit, for good.
std::string LimitFor(const std::string& user, const std::string& limit) {
  return "put \"" + user + " - " + limit +
         "\" into /etc/security/limits.d/pliant.conf (or \"@realtime - " + limit +
         "\" for the members of a group realtime), then log in anew";
}

constexpr char kClearFaults[] =
    "mend what the faults are about, then `pliant recover gen3 --clear-faults`";

std::string Listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

Finding CheckJoint(const std::string& subject, const ArmJoint& joint) {
  char found[96];
  std::snprintf(found, sizeof found, "%d different torques of %d, motor %.0f C, core %.0f C",
                joint.torques, kFeedbacks, joint.motor_temperature, joint.core_temperature);
  if (!joint.faults.empty())
    return {Verdict::Missing, subject, std::string(found) + ", " + Listed(joint.faults),
            kClearFaults};
  if (joint.torques == 1)
    return {Verdict::Missing, subject, found,
            "its torque sensor is dead: do not control its torque; switch the arm off and on, or "
            "ask Kinova"};
  if (joint.torques < kFeedbacks / 2)
    return {Verdict::Note, subject, found,
            "expected nearly as many: is the sensor well, or feedback slower than each "
            "millisecond?"};
  return {Verdict::Ok, subject, found};
}

Verdict Needed(bool good, bool needed) {
  if (good) return Verdict::Ok;
  return needed ? Verdict::Missing : Verdict::Note;
}

}  // namespace

std::string Finding::text() const {
  constexpr const char* kWords[] = {"ok", "missing", "note"};
  char head[64];
  std::snprintf(head, sizeof head, "%-8s %-17s ", kWords[static_cast<int>(verdict)],
                subject.c_str());
  return head + found + (way_out.empty() ? "" : "; " + way_out);
}

Finding CheckProgram(const std::string& name, const std::string& package,
                     const std::string& fault) {
  if (fault.empty()) return {Verdict::Ok, name, "it runs"};
  return {Verdict::Missing, name, fault,
          "install the Debian package " + package + ", or put " + name + "'s folder on PATH"};
}

Finding CheckShared(const SharedFolder& folder) {
  if (folder.fault.empty()) return {Verdict::Ok, folder.name, folder.place};
  return {Verdict::Missing, folder.name, folder.fault,
          "install pliant anew, or set PLIANT_SHARE to the folder that has it"};
}

Finding CheckOutput(const OutputFolder& folder) {
  if (!folder.fault.empty())
    return {Verdict::Missing, "output", folder.place + " cannot be written to: " + folder.fault,
            "go to another folder, or give one with --out"};
  const std::string found = folder.place + ", " + Size(folder.free_bytes) + " free";
  // An arm's log has some 1 MB a second.
  if (folder.free_bytes >= kGigabyte) return {Verdict::Ok, "output", found};
  const bool none = folder.free_bytes < kGigabyte / 10;
  return {none ? Verdict::Missing : Verdict::Note, "output", found,
          "make room, a second of a run takes about 1 MB; or give another folder with --out"};
}

std::vector<Finding> CheckRealTime(const RealTimeFacts& f, bool for_arm) {
  std::vector<Finding> all;
  const auto add = [&](Verdict verdict, const char* subject, const std::string& found,
                       const std::string& way_out) {
    all.push_back({verdict, subject, found, verdict == Verdict::Ok ? "" : way_out});
  };
  const bool fifo = f.fifo_fault.empty(), memory = f.memory_fault.empty();
  add(Needed(fifo, for_arm), "SCHED_FIFO",
      fifo ? "granted" : f.fifo_fault + ", priorities up to " + std::to_string(f.rtprio),
      LimitFor(f.user, "rtprio 95"));
  add(Needed(memory, for_arm), "locked memory",
      memory ? "granted" : f.memory_fault + ", up to " + Size(f.memlock),
      LimitFor(f.user, "memlock unlimited"));
  const bool in_time = f.worst_s <= kLatestWake;
  add(Needed(in_time, for_arm), "waking",
      "late by " + Micro(f.median_s) + " in the middle, " + Micro(f.worst_s) +
          " at worst, of 500 times" + (fifo ? "" : ", without SCHED_FIFO"),
      "expected at most " + Micro(kLatestWake) +
          (fifo ? "; see the notes below, and what else runs" : "; see SCHED_FIFO"));
  add(f.preempt_rt ? Verdict::Ok : Verdict::Note, "kernel",
      f.kernel + (f.preempt_rt ? ", PREEMPT_RT" : ", not PREEMPT_RT"),
      "Debian's package linux-image-rt-amd64 has one that is");
  const bool steady = f.governor.empty() || f.governor == "performance";
  add(steady ? Verdict::Ok : Verdict::Note, "frequency",
      f.governor.empty() ? "the kernel does not change it" : "governor " + f.governor,
      "`cpupower frequency-set -g performance` as root keeps it up");
  const bool alone = f.processors > 1 && !f.isolated.empty();
  add(alone ? Verdict::Ok : Verdict::Note, "processors",
      std::to_string(f.processors) + ", " +
          (f.isolated.empty() ? "none isolated" : "isolated: " + f.isolated),
      f.processors > 1 ? "isolcpus=" + std::to_string(f.processors - 1) +
                             " on the kernel's command line keeps one for the loop"
                       : "a second one would take what is not the loop");
  const bool slow = f.clock == "hpet" || f.clock == "acpi_pm" || f.clock == "jiffies" ||
                    f.clock == "refined-jiffies";
  add(slow ? Verdict::Note : Verdict::Ok, "clock", f.clock.empty() ? "not known" : f.clock,
      "it is slow to read; tsc is not, see /sys/devices/system/clocksource");
  return all;
}

std::vector<Finding> CheckArm(const std::optional<ArmFacts>& facts) {
  if (!facts)
    return {{Verdict::Note, "arm", "not tried",
             "--arm ADDRESS tries one; a Gen3 comes as 192.168.1.10"}};
  if (!facts->fault.empty())
    return {{Verdict::Missing, "arm", facts->address + ": " + facts->fault,
             "is it switched on and wired, and this machine in its network (a Gen3's is "
             "192.168.1.0/24)?"}};
  std::vector<Finding> all{
      {Verdict::Ok, "arm",
       facts->address + " answered in " + Micro(facts->answered_s) + " by TCP"}};
  if (!facts->session_fault.empty())
    all.push_back({Verdict::Missing, "arm session", facts->session_fault});
  if (!facts->state.empty()) {
    const std::string found = facts->state + ", " + facts->servoing +
                              (facts->faults.empty() ? "" : ", " + Listed(facts->faults));
    if (facts->state == "ARMSTATE_IN_FAULT" || !facts->faults.empty())
      all.push_back({Verdict::Missing, "arm state", found, kClearFaults});
    else if (facts->left_low_level)
      all.push_back(
          {Verdict::Note, "arm state", found,
           "a program runs it, or has left it: then `pliant recover gen3` brings it back"});
    else
      all.push_back({Verdict::Ok, "arm state", found});
  }
  for (std::size_t i = 0; i < facts->joints.size(); ++i)
    all.push_back(CheckJoint("arm joint " + std::to_string(i + 1), facts->joints[i]));
  return all;
}

}  // namespace pliant
