#include "pliant/systems/real_time_permissions.h"

#include <alloca.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "pliant/systems/error.h"

namespace pliant {

namespace {

constexpr std::size_t kStack = 512 * 1024;  // [B] more than the rules of any diagram take
constexpr std::size_t kPage = 4096;         // [B] the smallest there is

std::string Reason(int error) { return std::strerror(error); }

std::string LimitOf(__rlimit_resource what, rlim_t unit) {
  rlimit limit{};
  getrlimit(what, &limit);
  return limit.rlim_cur == RLIM_INFINITY ? "unlimited" : Text(limit.rlim_cur / unit);
}

std::string WayOut(const std::string& ulimit, const std::string& now, const std::string& line,
                   const std::string& capability) {
  return "\nraise ulimit " + ulimit + ", now " + now + ", by a line \"USER - " + line +
         "\" in /etc/security/limits.d, or give the program " + capability;
}

/// Touches the stack below, or half of what is left of it.
[[gnu::noinline]] void TouchStack() {
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return;
  void* lowest = nullptr;
  std::size_t size = 0;
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  const auto* here = static_cast<const char*>(__builtin_frame_address(0));
  const auto left = static_cast<std::size_t>(here - static_cast<const char*>(lowest));
  const std::size_t touched = std::min(kStack, left / 2);
  volatile char* const bytes = static_cast<volatile char*>(alloca(touched));
  for (std::size_t i = touched; i-- > 0;)
    if (i % kPage == 0) bytes[i] = 0;
}

std::string ProcessorsOf(const cpu_set_t& set) {
  std::string text;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &set)) text += (text.empty() ? "" : ", ") + Text(i);
  return text;
}

}  // namespace

struct RealTimePermissions::Before {
  bool locked = false;
  std::optional<cpu_set_t> processors;
  std::optional<int> policy;
  sched_param priority{};
};

void RealTimePermissions::Check(const Options& o) {
  if (o.priority)
    Require(*o.priority >= 1 && *o.priority <= 99, "priority must be from 1 to 99", *o.priority);
  if (o.cpu)
    Require(*o.cpu >= 0 && *o.cpu < CPU_SETSIZE, "cpu must be from 0 to " + Text(CPU_SETSIZE - 1),
            *o.cpu);
}

RealTimePermissions::RealTimePermissions(const Options& o) : before_{std::make_unique<Before>()} {
  Check(o);
  if (o.lock_memory) LockMemory();
  if (o.cpu) StayOn(*o.cpu);
  if (o.priority) Prefer(*o.priority);
}

RealTimePermissions::~RealTimePermissions() {
  if (before_->policy) pthread_setschedparam(pthread_self(), *before_->policy, &before_->priority);
  if (before_->processors)
    pthread_setaffinity_np(pthread_self(), sizeof(cpu_set_t), &*before_->processors);
  if (before_->locked) munlockall();
}

void RealTimePermissions::LockMemory() {
  TouchStack();
  before_->locked = mlockall(MCL_CURRENT) == 0;
  if (before_->locked) return;
  refused_.push_back(
      "memory is not locked: " + Reason(errno) +
      WayOut("-l", LimitOf(RLIMIT_MEMLOCK, 1024) + " kB", "memlock unlimited", "CAP_IPC_LOCK"));
}

void RealTimePermissions::StayOn(int cpu) {
  cpu_set_t now, one;
  CPU_ZERO(&now);
  CPU_ZERO(&one);
  CPU_SET(static_cast<std::size_t>(cpu), &one);
  pthread_getaffinity_np(pthread_self(), sizeof now, &now);
  if (const int error = pthread_setaffinity_np(pthread_self(), sizeof one, &one))
    refused_.push_back("the run does not stay on processor " + Text(cpu) + ": " + Reason(error) +
                       "\nchoose one of " + ProcessorsOf(now));
  else
    before_->processors = now;
}

void RealTimePermissions::Prefer(int priority) {
  int policy = 0;
  sched_param now{};
  pthread_getschedparam(pthread_self(), &policy, &now);
  sched_param wanted{};
  wanted.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &wanted)) {
    refused_.push_back("priority " + Text(priority) +
                       " of SCHED_FIFO is refused: " + Reason(error) +
                       WayOut("-r", LimitOf(RLIMIT_RTPRIO, 1), "rtprio 95", "CAP_SYS_NICE"));
  } else {
    before_->policy = policy;
    before_->priority = now;
  }
}

}  // namespace pliant
