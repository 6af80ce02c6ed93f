#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

enum class Verdict { Ok, Missing, Note };

/// A line of `pliant doctor`: what was looked at, what was found, and what would mend it.
struct Finding {
  Verdict verdict;
  std::string subject;
  std::string found;
  std::string way_out = {};  ///< empty if nothing is to be mended

  /// "missing  gnuplot           not found; install the Debian package gnuplot-nox".
  std::string text() const;
};

/// A folder that comes with pliant: where it is, or why it was not found.
struct SharedFolder {
  std::string name, place, fault;
};

/// Where logs and reports are to go.
struct OutputFolder {
  std::string place;
  std::string fault;  ///< why nothing can be written there; empty: it can
  std::uint64_t free_bytes;
};

/// What the kernel lets a process do, and how well.
struct RealTimeFacts {
  std::string user;
  std::string fifo_fault;    ///< why SCHED_FIFO was refused; empty: it was not
  std::uint64_t rtprio;      ///< RLIMIT_RTPRIO
  std::string memory_fault;  ///< why mlockall was refused; empty: it was not
  std::uint64_t memlock;     ///< RLIMIT_MEMLOCK [bytes]
  bool preempt_rt;
  std::string kernel;        ///< its release
  std::string governor;      ///< of the processors' frequency; empty: the kernel leaves it alone
  int processors;            ///< that this process may use
  std::string isolated;      ///< processors that nothing else is put on, such as "2-3"
  std::string clock;         ///< the kernel's clock source
  double median_s, worst_s;  ///< how late a thread wakes that sleeps until each millisecond
};

/// So many feedbacks are read, one each millisecond.
inline constexpr int kFeedbacks = 300;

/// What a joint of an arm that is tried said in that time.
struct ArmJoint {
  int torques;                                 ///< how many different ones
  double motor_temperature, core_temperature;  ///< [°C], the last
  std::vector<std::string> faults;             ///< by the arm's names
};

/// The arm at an address; `fault` says why it did not answer, `session_fault` why it did not go on
/// from there.
struct ArmFacts {
  std::string address;
  std::string fault = {};
  double answered_s = 0;
  std::string session_fault = {};
  std::string state = {}, servoing = {};  ///< by the arm's names; empty: not known
  bool left_low_level = false;            ///< it waits for commands that nobody sends
  std::vector<std::string> faults = {};   ///< of its base
  std::vector<ArmJoint> joints = {};      ///< empty: no feedback
};

/// A thread may wake so late, of a tick of 1 ms: what is left is for the controller, some 0.1 ms,
/// and for the way to the arm and back.
inline constexpr double kLatestWake = 200e-6;

/// A program that draws, and the Debian package that has it.
Finding CheckProgram(const std::string& name, const std::string& package, const std::string& fault);
Finding CheckShared(const SharedFolder& folder);
Finding CheckOutput(const OutputFolder& folder);

/// Nothing of it is needed to simulate. To run an arm, SCHED_FIFO, locked memory and waking in time
/// are; the rest is where to look if a thread wakes late.
std::vector<Finding> CheckRealTime(const RealTimeFacts& facts, bool for_arm);

/// Without facts it only says how to try. A torque sensor has noise: one that says the same all the
/// time is dead, and few different values are worth a look.
std::vector<Finding> CheckArm(const std::optional<ArmFacts>& facts);

}  // namespace pliant
