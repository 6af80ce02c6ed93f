#include "pliant/apps/machine_facts.h"

#include <pthread.h>
#include <pwd.h>
#include <sched.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

namespace pliant {

namespace {

namespace fs = std::filesystem;

/// The first line of a file; empty if it cannot be read.
std::string LineOf(const char* file) {
  std::string line;
  std::getline(std::ifstream(file) >> std::ws, line);
  return line;
}

std::uint64_t Limit(__rlimit_resource what) {
  rlimit limit{};
  getrlimit(what, &limit);
  return limit.rlim_cur == RLIM_INFINITY ? UINT64_MAX : limit.rlim_cur;
}

std::string User() {
  const passwd* const user = getpwuid(getuid());
  return user ? user->pw_name : std::to_string(getuid());
}

/// Why memory cannot be locked; what was locked is free again.
std::string LockMemory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) return std::strerror(errno);
  munlockall();
  return "";
}

/// What a thread of its own sees, which ends with whatever priority it got.
void MeasureWaking(RealTimeFacts& facts) {
  const sched_param priority{.sched_priority = 80};
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  facts.fifo_fault = refused ? std::strerror(refused) : "";

  std::vector<double> late(500);
  timespec next{};
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (double& s : late) {
    next.tv_nsec += 1'000'000;
    if (next.tv_nsec >= 1'000'000'000) next = {next.tv_sec + 1, next.tv_nsec - 1'000'000'000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr) == EINTR) continue;
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    s = static_cast<double>(now.tv_sec - next.tv_sec) +
        1e-9 * static_cast<double>(now.tv_nsec - next.tv_nsec);
  }
  std::ranges::sort(late);
  facts.median_s = late[late.size() / 2];
  facts.worst_s = late.back();
}

}  // namespace

RealTimeFacts RealTimeOfThisMachine() {
  RealTimeFacts facts{};
  facts.user = User();
  facts.rtprio = Limit(RLIMIT_RTPRIO);
  facts.memlock = Limit(RLIMIT_MEMLOCK);
  facts.memory_fault = LockMemory();
  facts.preempt_rt = LineOf("/sys/kernel/realtime") == "1";
  utsname kernel{};
  uname(&kernel);
  facts.kernel = kernel.release;
  facts.governor = LineOf("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  cpu_set_t usable;
  CPU_ZERO(&usable);
  const bool known = sched_getaffinity(0, sizeof usable, &usable) == 0;
  facts.processors =
      known ? CPU_COUNT(&usable) : static_cast<int>(std::thread::hardware_concurrency());
  facts.isolated = LineOf("/sys/devices/system/cpu/isolated");
  facts.clock = LineOf("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  std::thread(MeasureWaking, std::ref(facts)).join();
  return facts;
}

OutputFolder OutputAt(const fs::path& folder) {
  OutputFolder facts{.place = {}, .fault = {}, .free_bytes = 0};
  std::error_code error;
  const fs::path asked = fs::absolute(folder, error);
  facts.place = fs::weakly_canonical(asked, error).string();
  if (error) facts.place = asked.string();
  fs::path there = asked;
  while (!fs::exists(there, error)) {
    if (error) {
      facts.fault = error.message();
      return facts;
    }
    there = there.parent_path();
  }
  std::string trial = (there / ".pliant-doctor-XXXXXX").string();
  const int descriptor = mkstemp(trial.data());
  if (descriptor < 0) {
    facts.fault = std::strerror(errno);
    return facts;
  }
  close(descriptor);
  unlink(trial.c_str());
  facts.free_bytes = fs::space(there, error).available;
  return facts;
}

}  // namespace pliant
