#include "pliant/systems/real_time_permissions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <fstream>
#include <vector>

#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/in_a_child.h"

namespace pliant {
namespace {

// A sanitizer lets a program lock nothing, and says that it did.
constexpr bool kLocksMemory = kCountsAllocations;

/// Of this process [kB].
int LockedMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (int kilobytes = 0; word == "VmLck:" && status >> kilobytes) return kilobytes;
  return -1;
}

int Priority() {
  int policy = 0;
  sched_param now{};
  pthread_getschedparam(pthread_self(), &policy, &now);
  return policy == SCHED_FIFO ? now.sched_priority : 0;
}

std::vector<int> Processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  pthread_getaffinity_np(pthread_self(), sizeof set, &set);
  std::vector<int> all;
  for (int i = 0; i < CPU_SETSIZE; ++i)
    if (CPU_ISSET(i, &set)) all.push_back(i);
  return all;
}

/// As a user who may nothing.
template <class Act>
std::string Powerless(const Act& act) {
  return InAChild([&] {
    const rlimit none{.rlim_cur = 0, .rlim_max = 0};
    setrlimit(RLIMIT_RTPRIO, &none);
    setrlimit(RLIMIT_MEMLOCK, &none);
    if (geteuid() == 0 && setuid(65534) != 0) return std::string("root stays root");
    return act();
  });
}

TEST(RealTimePermissions, AreGivenBack) {
  const std::vector<int> processors = Processors();
  const int priority = Priority(), locked = LockedMemory();
  {
    const RealTimePermissions granted(
        {.priority = 7, .lock_memory = true, .cpu = processors.back()});
    if (granted.refused().empty()) {
      EXPECT_EQ(Priority(), 7);
      EXPECT_EQ(LockedMemory() > 0, kLocksMemory);
    }
    EXPECT_EQ(Processors(), std::vector{processors.back()});
  }
  EXPECT_EQ(Priority(), priority);
  EXPECT_EQ(LockedMemory(), locked);
  EXPECT_EQ(Processors(), processors);
}

TEST(RealTimePermissions, ChangeNothingUnasked) {
  const std::vector<int> processors = Processors();
  const int priority = Priority(), locked = LockedMemory();
  const RealTimePermissions none({});
  EXPECT_TRUE(none.refused().empty());
  EXPECT_EQ(Priority(), priority);
  EXPECT_EQ(LockedMemory(), locked);
  EXPECT_EQ(Processors(), processors);
}

TEST(RealTimePermissions, TellWhyPriorityIsRefusedAndTheWayOut) {
  const std::string told = Powerless([] {
    const RealTimePermissions refused({.priority = 80});
    return refused.refused().at(0) + "\npriority " + std::to_string(Priority());
  });
  EXPECT_EQ(told,
            "priority 80 of SCHED_FIFO is refused: Operation not permitted\n"
            "raise ulimit -r, now 0, by a line \"USER - rtprio 95\" in /etc/security/limits.d, or "
            "give the program CAP_SYS_NICE\n"
            "priority 0");
}

TEST(RealTimePermissions, TellWhyMemoryIsNotLockedAndTheWayOut) {
  if (!kLocksMemory) return;
  const std::string told = Powerless([] {
    const RealTimePermissions refused({.lock_memory = true});
    return refused.refused().at(0) + "\nlocked " + std::to_string(LockedMemory());
  });
  EXPECT_EQ(told,
            "memory is not locked: Operation not permitted\n"
            "raise ulimit -l, now 0 kB, by a line \"USER - memlock unlimited\" in "
            "/etc/security/limits.d, or give the program CAP_IPC_LOCK\n"
            "locked 0");
}

TEST(RealTimePermissions, TellWhichProcessorsThereAre) {
  const RealTimePermissions refused({.cpu = CPU_SETSIZE - 1});
  ASSERT_EQ(refused.refused().size(), 1u);
  EXPECT_THAT(refused.refused()[0],
              testing::StartsWith("the run does not stay on processor 1023: Invalid argument\n"
                                  "choose one of " +
                                  std::to_string(Processors().front())));
}

TEST(RealTimePermissions, LeaveAThreadWithASmallStackAlone) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, 128 * 1024);
  pthread_t thread;
  const auto lock = [](void*) -> void* {
    const RealTimePermissions permissions({.lock_memory = true});
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, lock, nullptr), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
}

TEST(RealTimePermissions, RefuseWhatNoMachineGives) {
  EXPECT_EQ(ErrorOf([] { RealTimePermissions({.priority = 0}); }),
            "priority must be from 1 to 99, got 0");
  EXPECT_EQ(ErrorOf([] { RealTimePermissions({.priority = 100}); }),
            "priority must be from 1 to 99, got 100");
  EXPECT_EQ(ErrorOf([] { RealTimePermissions({.cpu = -1}); }),
            "cpu must be from 0 to 1023, got -1");
}

}  // namespace
}  // namespace pliant
