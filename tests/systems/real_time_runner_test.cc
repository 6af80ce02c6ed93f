#include "pliant/systems/real_time_runner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>

#include "pliant/systems/constant.h"
#include "pliant/systems/gain.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/low_pass.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/in_a_child.h"
#include "pliant/tests/support/kernel_blocks.h"

namespace pliant {
namespace {

using std::chrono::steady_clock;

double Since(steady_clock::time_point begin) {
  return std::chrono::duration<double>(steady_clock::now() - begin).count();
}

/// Calls back at every tick.
class AtTicks final : public Block {
 public:
  struct Options {
    std::function<void(std::int64_t k)> act;
    Duration period;
  };
  explicit AtTicks(const Options& o) : k{this, "k"}, act_{o.act} {
    Every(o.period).Publish().From(k).As(&AtTicks::Act);
    Every(o.period).Update(k).From(k).As([](std::int64_t now) { return now + 1; });
  }
  Discrete<std::int64_t> k;

 private:
  void Act(std::int64_t now) const { act_(now); }
  const std::function<void(std::int64_t)> act_;
};

/// ẋ = −a x, from 1 down to 0.9, and from 1 again.
class Decay final : public Block {
 public:
  explicit Decay(double rate) : x{this, "x", {}, 1.0}, y{this, "y"}, rate_{rate} {
    Derivative(x).From(x).As(&Decay::Rate);
    Compute(y).From(x).As([](double now) { return now - 0.9; });
    When(y).Crosses(Direction::Falling).Update(x).From().As([] { return 1.0; });
  }
  Continuous<double> x;
  Output<double> y;

 private:
  double Rate(double now) const { return -rate_ * now; }
  const double rate_;
};

/// A loop of a filter at 1 ms and an integral with guards, and what is recorded at 3 ms.
Diagram MakeLoop(std::vector<Recorder::Row>& rows) {
  DiagramBuilder b;
  auto& decay = b.Add<Decay>("decay", 20.0);
  auto& sum = b.Add<Sum>("sum");
  auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 30, .period = 1ms});
  auto& integral = b.Add<Integral>("integral");
  auto& delay = b.Add<Delay>("delay", {.period = 2ms});
  auto& recorder = b.Add<Recorder>("recorder", {.rows = rows, .period = 3ms});
  b.Connect(decay.y, sum.a);
  b.Connect(delay.y, sum.b);
  b.Connect(sum.y, filter.u);
  b.Connect(filter.y, integral.u);
  b.Connect(integral.y, delay.u);
  b.Connect(filter.y, recorder.a);
  b.Connect(integral.y, recorder.b);
  return b.Build();
}

TEST(RealTimeRunner, RunsTheSimulationBitForBit) {
  std::vector<Recorder::Row> rows;
  const Diagram diagram = MakeLoop(rows);
  Simulator reference{diagram};
  reference.AdvanceTo(0.1);
  const Context expected = reference.Snapshot();
  const std::vector<Recorder::Row> expected_rows = std::exchange(rows, {});
  for (const bool paced : {false, true})
    for (const double pause : {0.0, 0.0415}) {
      Simulator sim{diagram};
      RealTimeRunner runner{sim, {.paced = paced}};
      runner.Run(pause);
      EXPECT_EQ(runner.Run(0.1).end, RunEnd::TimeReached);
      EXPECT_EQ(sim.time(), 0.1);
      EXPECT_EQ(std::exchange(rows, {}), expected_rows);
      EXPECT_TRUE(sim.Snapshot() == expected);
    }
}

TEST(RealTimeRunner, TakesNoLessThanItsTimeWhenPaced) {
  DiagramBuilder b;
  std::vector<double> begins;
  steady_clock::time_point begin;
  b.Add<AtTicks>("ticks",
                 {.act = [&](std::int64_t) { begins.push_back(Since(begin)); }, .period = 5ms});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  RealTimeRunner runner{sim, {.overrun = Overrun::CatchUp, .catch_up = 1'000'000}};
  begin = steady_clock::now();
  const RunReport& report = runner.Run(0.1);
  EXPECT_GE(Since(begin), 0.1);
  ASSERT_EQ(begins.size(), 20u);
  for (int k = 0; k < 20; ++k) EXPECT_GE(begins[static_cast<std::size_t>(k)], 5e-3 * k);
  EXPECT_EQ(report.ticks, 20);
  EXPECT_EQ(report.period.count(), 19);
  EXPECT_EQ(report.lateness.count(), 20);
  EXPECT_EQ(report.compute.count(), 20);
  EXPECT_EQ(report.skipped, 0);
}

TEST(RealTimeRunner, WaitsForNothingWhenUnpaced) {
  const auto times = std::make_shared<TickTimes>();
  DiagramBuilder b;
  b.Add<AtTicks>("ticks", {.act = [](std::int64_t) {}, .period = 1s});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  RealTimeRunner runner{sim, {.paced = false, .overrun = Overrun::Stop, .times = times}};
  const RunReport& report = runner.Run(1000);
  EXPECT_EQ(report.end, RunEnd::TimeReached);
  EXPECT_EQ(report.ticks, 1000);
  EXPECT_EQ(report.missed, 0);
  EXPECT_EQ(report.lateness.count(), 0);
  EXPECT_EQ(report.compute.count(), 1000);
  EXPECT_EQ(times->lateness_ns, 0);
  EXPECT_GT(times->compute_ns, 0);
}

constexpr double kPeriod = 20e-3;  // [s] long beside what a busy machine takes away

struct Hiccup {
  RunReport report;
  double reached;                                          // [s] of the diagram
  double lasted;                                           // [s] by the wall clock
  std::vector<double> overran, lateness, missed, compute;  // as the diagram saw them
};

/// Ten ticks, of which tick 3 takes five periods.
Hiccup RunWithAHiccup(Overrun overrun, int catch_up = 10) {
  const auto times = std::make_shared<TickTimes>();
  DiagramBuilder b;
  auto& timer = b.Add<TickTimer>("timer", {.times = times, .period = 20ms});
  auto& logger = b.Add<Logger>("logger", {.period = 20ms, .capacity = 100});
  b.Add<AtTicks>("ticks", {.act =
                               [](std::int64_t k) {
                                 const auto begin = steady_clock::now();
                                 while (k == 3 && Since(begin) < 5 * kPeriod) continue;
                               },
                           .period = 20ms});
  b.Connect(timer.timing, logger.in);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  RealTimeRunner runner{sim, {.overrun = overrun, .catch_up = catch_up, .times = times}};
  const auto begin = steady_clock::now();
  runner.Run(10 * kPeriod);
  const double lasted = Since(begin);
  const Log& log = sim.Get(logger.log);
  const auto column = [&](const std::string& name) {
    const auto& values = log["timer.timing." + name];
    return std::vector<double>(values.begin(), values.end());
  };
  return {runner.report(),    sim.time(),       lasted,           column("overran"),
          column("lateness"), column("missed"), column("compute")};
}

// A busy machine may make a tick later, never earlier: all bounds hold in any case.

TEST(RealTimeRunner, MovesItsScheduleOnWhenItSkips) {
  const Hiccup run = RunWithAHiccup(Overrun::Skip);
  EXPECT_EQ(run.report.end, RunEnd::TimeReached);
  EXPECT_EQ(run.report.ticks, 10);
  EXPECT_GE(run.report.skipped, 4);
  EXPECT_EQ(run.report.missed, run.report.skipped);
  EXPECT_DOUBLE_EQ(run.report.behind, kPeriod * static_cast<double>(run.report.skipped));
  EXPECT_GE(run.lasted, 10 * kPeriod + run.report.behind);
  EXPECT_EQ(run.reached, 10 * kPeriod);
}

TEST(RealTimeRunner, KeepsItsScheduleWhenItCatchesUp) {
  const Hiccup run = RunWithAHiccup(Overrun::CatchUp, 1000);
  EXPECT_EQ(run.report.end, RunEnd::TimeReached);
  EXPECT_EQ(run.report.ticks, 10);
  EXPECT_EQ(run.report.skipped, 0);
  EXPECT_EQ(run.report.behind, 0);
  EXPECT_GE(run.report.missed, 4);  // ticks 4 to 7, late by 4, 3, 2 and 1 periods
  EXPECT_GE(run.lasted, 10 * kPeriod);
}

TEST(RealTimeRunner, SkipsWhatItMayNotCatchUp) {
  const Hiccup run = RunWithAHiccup(Overrun::CatchUp, 2);
  EXPECT_EQ(run.report.ticks, 10);
  EXPECT_GE(run.report.skipped, 2);                      // of the 4 missed
  EXPECT_GE(run.report.missed, run.report.skipped + 2);  // ticks 4 and 5
  EXPECT_DOUBLE_EQ(run.report.behind, kPeriod * static_cast<double>(run.report.skipped));
}

TEST(RealTimeRunner, StopsBeforeTheTickThatIsLate) {
  const Hiccup run = RunWithAHiccup(Overrun::Stop);
  EXPECT_EQ(run.report.end, RunEnd::Overran);
  EXPECT_LE(run.report.ticks, 4);
  EXPECT_GE(run.report.missed, run.report.ticks == 4 ? 4 : 1);
  EXPECT_EQ(run.report.skipped, 0);
  EXPECT_NEAR(run.reached,
              kPeriod * static_cast<double>(std::max<std::int64_t>(0, run.report.ticks - 1)),
              1e-12);
  EXPECT_THAT(run.report.reason, testing::HasSubstr("since the next tick would begin "));
  EXPECT_THAT(run.report.reason,
              testing::HasSubstr(" late, which is no less than the period of 20 ms"));
}

TEST(RealTimeRunner, ShowsTheDiagramWhatItMissed) {
  const Hiccup run = RunWithAHiccup(Overrun::Skip);
  ASSERT_EQ(run.overran.size(), 10u);
  EXPECT_EQ(run.compute[0], 0);
  EXPECT_GE(run.compute[4], 5 * kPeriod);
  EXPECT_GE(run.lateness[4], 4 * kPeriod);
  EXPECT_EQ(run.overran[4], 1);
  EXPECT_GE(run.missed[4] - run.missed[3], 4);
  EXPECT_EQ(run.missed[9], static_cast<double>(run.report.missed));
}

TEST(RealTimeRunner, StopsWhenAsked) {
  std::atomic<bool> stop = false;
  DiagramBuilder b;
  b.Add<AtTicks>("ticks", {.act = [&](std::int64_t k) { stop = k == 4; }, .period = 1ms});
  const Diagram diagram = b.Build();
  for (const bool paced : {false, true}) {
    Simulator sim{diagram};
    stop = false;
    RealTimeRunner runner{sim, {.paced = paced, .stop = &stop}};
    const RunReport& report = runner.Run();
    EXPECT_EQ(report.end, RunEnd::StopAsked);
    EXPECT_EQ(report.ticks, 5);
    EXPECT_EQ(sim.time(), 4e-3);
    EXPECT_EQ(report.reason, "it was asked to stop at t = 0.004 s");
  }
}

std::atomic<bool> alarmed;

TEST(RealTimeRunner, WakesUpWhenASignalAsksItToStop) {
  DiagramBuilder b;
  b.Add<AtTicks>("ticks", {.act = [](std::int64_t) { alarm(1); }, .period = 1000s});
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  alarmed = false;
  const auto before = std::signal(SIGALRM, [](int) { alarmed = true; });
  RealTimeRunner runner{sim, {.stop = &alarmed}};
  EXPECT_EQ(runner.Run().end, RunEnd::StopAsked);
  std::signal(SIGALRM, before);
}

/// A filter, a gain and a delay, which allocate nothing, and a callback.
Diagram MakeQuiet(std::function<void(std::int64_t)> act) {
  DiagramBuilder b;
  auto& one = b.Add<Constant<double>>("one", {.value = 1});
  auto& filter = b.Add<LowPass<double>>("filter", {.cutoff_hz = 30, .period = 1ms});
  auto& gain = b.Add<Gain<double>>("gain", {.gain = 2});
  auto& delay = b.Add<Delay>("delay", {.period = 1ms});
  b.Add<AtTicks>("ticks", {.act = std::move(act), .period = 1ms});
  b.Connect(one.y, filter.u);
  b.Connect(filter.y, gain.u);
  b.Connect(gain.y, delay.u);
  return b.Build();
}

TEST(RealTimeRunner, TakesNothingFromTheHeapInItsLoop) {
  long first = 0, last = 0;
  const Diagram diagram = MakeQuiet([&](std::int64_t k) {
    if (k == 0) first = Allocations();
    last = Allocations();
  });
  for (const bool paced : {false, true}) {
    Simulator sim{diagram};
    RealTimeRunner runner{sim, {.paced = paced}};
    EXPECT_EQ(runner.Run(0.1).ticks, 100);
    EXPECT_EQ(last - first, 0);
  }
}

volatile int system_calls = 0;

/// From here on all system calls of this process are counted and not done, but for the sleep, the
/// end, and the way back from a signal.
void CountSystemCalls() {
  struct sigaction action {};
  action.sa_handler = [](int) { system_calls = system_calls + 1; };
  sigaction(SIGSYS, &action, nullptr);
  const auto allow = [](unsigned call) {
    return sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
  };
  const sock_filter yes = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  sock_filter filter[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                          allow(SYS_clock_nanosleep),
                          yes,
                          allow(SYS_rt_sigreturn),
                          yes,
                          allow(SYS_exit_group),
                          yes,
                          BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP)};
  const sock_fprog program{.len = static_cast<unsigned short>(std::size(filter)), .filter = filter};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 ||
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
    _exit(100);
}

/// What a process of its own ends with.
template <class Act>
int EndOf(const Act& act) {
  const pid_t child = fork();
  if (child == 0) _exit(act());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -status;
}

/// Whether reading the clock is one, as with a clock source that programs cannot read.
bool ClockIsASystemCall() {
  return EndOf([] {
           CountSystemCalls();
           timespec now;
           clock_gettime(CLOCK_MONOTONIC, &now);
           return int{system_calls};
         }) == 1;
}

/// System calls of ticks 10 to 60 of a run in a process of its own; 100: they cannot be counted.
int SystemCallsOf(void (*rule)(), const RealTimeRunner::Options& options) {
  return EndOf([&] {
    const Diagram diagram = MakeQuiet([rule](std::int64_t k) {
      if (k == 10) CountSystemCalls();
      if (k > 10) rule();
      if (k == 60) _exit(std::min(int{system_calls}, 99));
    });
    Simulator sim{diagram};
    RealTimeRunner runner{sim, options};
    runner.Run(1);
    return 101;
  });
}

TEST(RealTimeRunner, MakesNoSystemCallInItsLoopButTheSleep) {
  if (!kCountsAllocations) return;   // a sanitizer makes calls of its own
  if (ClockIsASystemCall()) return;  // as on some virtual machines
  const auto nothing = [] {};
  const int counted = SystemCallsOf([] { syscall(SYS_getppid); }, {.paced = false});
  if (counted == 100) return;  // this machine does not let programs filter calls
  ASSERT_EQ(counted, 50);      // of ticks 11 to 60: the count is a true one
  EXPECT_EQ(SystemCallsOf(nothing, {.paced = false}), 0);
  EXPECT_EQ(SystemCallsOf(nothing, {}), 0);
  EXPECT_EQ(SystemCallsOf(nothing, {.overrun = Overrun::CatchUp,
                                    .permissions = {.priority = 1, .lock_memory = true, .cpu = 0}}),
            0);
}

TEST(RealTimeRunner, ChangesInputsAtATickAndNotBefore) {
  class Tank final : public Block {
   public:
    Tank() {
      Derivative(level).From(flow).As([](double u) { return u; });
      Every(10ms).Compute(seen).From(level).As([](double x) { return x; });
    }
    Input<double> flow{this, "flow", {}, 0};
    Continuous<double> level{this, "level"};
    Output<double> seen{this, "seen"};
  };
  DiagramBuilder b;
  auto& tank = b.Add<Tank>("tank");
  const Diagram diagram = b.Build();
  Simulator sim(diagram);
  const auto open_at_20_ms = [&](Simulator& s, const RunReport&) {
    if (s.next_tick_ns() == 20'000'000) s.Set(tank.flow, 3);
  };
  RealTimeRunner(sim, {.paced = false, .before_tick = open_at_20_ms}).Run(0.045);
  // What RK methods make of a constant rate is exact but for rounding.
  EXPECT_NEAR(sim.Get(tank.seen), 3 * 0.02, 1e-15);
  EXPECT_NEAR(sim.Get(tank.level), 3 * 0.025, 1e-15);
}

TEST(RealTimeRunner, ReportsAndSurvivesWhatIsRefused) {
  const Diagram diagram = MakeQuiet([](std::int64_t) {});
  Simulator sim{diagram};
  RealTimeRunner runner{sim, {.permissions = {.cpu = 1023}}};
  const RunReport& report = runner.Run(0.005);
  EXPECT_EQ(report.ticks, 5);
  ASSERT_EQ(report.refused.size(), 1u);
  EXPECT_THAT(report.text(), testing::HasSubstr("\nthe run does not stay on processor 1023: "));
}

TEST(RealTimeRunner, PassesOnWhatTheIntegratorThrowsAndGivesPermissionsBack) {
  DiagramBuilder b;
  auto& source = b.Add<Source>(
      "source", [](double t) { return t < 0.02 ? 1.0 : std::numeric_limits<double>::quiet_NaN(); });
  auto& integral = b.Add<Integral>("integral");
  auto& sampler = b.Add<Sampler>("sampler", {.period = 1ms});
  b.Connect(source.y, integral.u);
  b.Connect(integral.y, sampler.u);
  const Diagram diagram = b.Build();
  Simulator sim{diagram};
  cpu_set_t before, after;
  sched_getaffinity(0, sizeof before, &before);
  int one = 0;
  while (!CPU_ISSET(one, &before)) ++one;
  RealTimeRunner runner{sim, {.permissions = {.cpu = one}}};
  EXPECT_THAT(ErrorOf([&] { runner.Run(1); }), testing::HasSubstr("integral.x"));
  sched_getaffinity(0, sizeof after, &after);
  EXPECT_TRUE(CPU_EQUAL(&before, &after));
  EXPECT_EQ(runner.report().end, RunEnd::Failed);
  EXPECT_EQ(runner.report().reason, "an exception ended it");
  EXPECT_GE(runner.report().ticks, 2);  // the first is at t = 0
  EXPECT_EQ(runner.report().compute.count(), runner.report().ticks - 1);
}

TEST(RealTimeRunner, ReportsATableForAPerson) {
  RunReport report;
  report.reason = "its end was reached, t = 2 s";
  report.ticks = 2000;
  report.missed = 3;
  report.skipped = 2;
  report.behind = 2e-3;
  for (int i = 0; i < 1999; ++i) report.period.Count(1'000'000);
  for (int i = 0; i < 2000; ++i) report.lateness.Count(i < 1990 ? 50 : 3'000'000);
  for (int i = 0; i < 2000; ++i) report.compute.Count(60);
  report.refused = {"memory is not locked: why\nthe way out"};
  EXPECT_EQ(report.text(),
            "2000 ticks, 3 missed, 2 skipped: the diagram's clock is 2 ms behind; its end was "
            "reached, t = 2 s\n"
            "                median      99 %    99.9 %     worst\n"
            "  period          1 ms      1 ms      1 ms      1 ms\n"
            "  lateness       50 ns     50 ns      3 ms      3 ms\n"
            "  compute        60 ns     60 ns     60 ns     60 ns\n"
            "memory is not locked: why\nthe way out");
  EXPECT_EQ(RunReport{}.text(), "0 ticks, 0 missed, 0 skipped; ");
}

TEST(RealTimeRunner, RefusesBadOptions) {
  const Diagram diagram = MakeQuiet([](std::int64_t) {});
  Simulator sim{diagram};
  const auto error = [&](const RealTimeRunner::Options& options) {
    return ErrorOf([&] { RealTimeRunner(sim, options); });
  };
  EXPECT_EQ(error({.catch_up = 0}), "catch_up must be >= 1, got 0");
  EXPECT_EQ(error({.permissions = {.priority = 100}}), "priority must be from 1 to 99, got 100");
  RealTimeRunner runner{sim, {.paced = false}};
  runner.Run(0.01);
  EXPECT_EQ(ErrorOf([&] { runner.Run(0.005); }),
            "Run: the end must not lie before the time reached, 0.01 s, got 0.005");
  EXPECT_EQ(ErrorOf([&] { runner.Run(std::nan("")); }),
            "Run: the end must not lie before the time reached, 0.01 s, got nan");

  DiagramBuilder b;
  b.Add<Constant<double>>("one", {.value = 1});
  const Diagram still = b.Build();
  Simulator constant{still};
  EXPECT_EQ(ErrorOf([&] { RealTimeRunner(constant, {}); }),
            "nothing ticks: no rule of the diagram has Every(period), by which a run could keep "
            "pace");
}

}  // namespace
}  // namespace pliant
