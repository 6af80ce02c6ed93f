// What a tick on an arm may not do: take from the heap, and call the system but for the exchange
// and the sleep.

#include <gtest/gtest.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "pliant/systems/real_time_runner.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/hardware_scene.h"

namespace pliant {
namespace {

/// Acts at each tick.
class Probe final : public Block {
 public:
  explicit Probe(std::function<void(double)> act) : act_{std::move(act)} {
    Publish(1ms).From(clock).As(&Probe::Act);
  }

 private:
  void Act(double t) const {
    if (act_) act_(t);
  }
  const std::function<void(double)> act_;
};

struct Running {
  explicit Running(const EmulatedArm& emulated, const std::function<void(double)>& act = {})
      : scenario{EcOnAnArm()},
        arm{emulated.Connect(scenario)},
        scene{Placed(), rows, {.arm = arm}},
        probe{scene.builder.Add<Probe>("probe", act)},
        diagram{scene.builder.Build()},
        sim{diagram} {}

  const Scenario& Placed() {
    std::get<Gen3Station>(scenario.station).position = arm->start().position;
    return scenario;
  }
  bool Runs() { return sim.Get(scene.safety->report).state == SafetyState::Running; }

  Scenario scenario;
  std::shared_ptr<Gen3Arm> arm;
  std::shared_ptr<Rows> rows = std::make_shared<Rows>();
  ScenarioDiagram scene;
  Probe& probe;
  Diagram diagram;
  Simulator sim;
};

TEST(HardwareTick, TakesNothingFromTheHeap) {
  const EmulatedArm emulated(true);
  Running run(emulated);
  for (int k = 0; k < 700; ++k) run.sim.AdvanceThroughTick();
  ASSERT_TRUE(run.Runs());
  const int rows = run.rows->rows;
  const long before = Allocations();
  for (int k = 0; k < 1000; ++k) run.sim.AdvanceThroughTick();
  EXPECT_EQ(Allocations() - before, 0);
  EXPECT_EQ(run.rows->rows - rows, 1000);
  EXPECT_EQ(run.sim.Get(run.scene.hardware->report).answered, 1699) << "each frame but the last";
}

volatile sig_atomic_t other_calls = 0;

/// System calls of this thread from here on are counted and not done, but for those of the exchange
/// and the sleep, and of a clock that programs cannot read by themselves.
bool CountOtherSystemCalls() {
  struct sigaction action {};
  action.sa_handler = [](int) { other_calls = other_calls + 1; };
  sigaction(SIGSYS, &action, nullptr);
  std::vector<sock_filter> filter{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
  for (const unsigned call : {SYS_clock_nanosleep, SYS_clock_gettime, SYS_sendto, SYS_recvfrom,
                              SYS_rt_sigreturn, SYS_exit_group}) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1));
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  }
  filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  const sock_fprog program{.len = static_cast<unsigned short>(filter.size()),
                           .filter = filter.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

/// Of ticks 1000 to 1200 of a paced run in a process of its own; 250: they cannot be counted.
int OtherCallsOf(const EmulatedArm& emulated, bool deliberate) {
  const pid_t child = fork();
  if (child == 0) {
    Running run(emulated, [deliberate](double t) {
      const auto k = static_cast<int>(1000 * t + 0.5);
      if (k == 1000 && !CountOtherSystemCalls()) _exit(250);
      if (k > 1000 && deliberate) syscall(SYS_getppid);
      if (k == 1200) _exit(std::min(int{other_calls}, 249));
    });
    RealTimeRunner(run.sim, {}).Run(10);
    _exit(251);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -status;
}

TEST(HardwareTick, MakesNoSystemCallButTheExchangeAndTheSleep) {
  if (!kCountsAllocations) return;  // a sanitizer makes calls of its own
  const EmulatedArm emulated(false);
  const int counted = OtherCallsOf(emulated, true);
  if (counted == 250) return;  // this machine does not let programs filter calls
  EXPECT_EQ(counted, 200) << "the count is a true one";
  const EmulatedArm another(false);
  EXPECT_EQ(OtherCallsOf(another, false), 0);
}

}  // namespace
}  // namespace pliant
