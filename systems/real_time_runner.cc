#include "pliant/systems/real_time_runner.h"

#include <time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>

#include "pliant/systems/time_text.h"

namespace pliant {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;  // [ns]
constexpr std::int64_t kForever = std::numeric_limits<std::int64_t>::max() / 2;

/// [ns] By the vDSO: no system call where the clock source allows it.
std::int64_t Now() {
  timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kSecond + now.tv_nsec;
}

std::int64_t Nanoseconds(double seconds) {
  return seconds < 9e9 ? std::llround(1e9 * seconds) : kForever;
}

std::int64_t ShortestPeriod(const Diagram& diagram) {
  const std::vector<internal::Rate>& rates = diagram.plan().rates;
  Require(
      !rates.empty(),
      "nothing ticks: no rule of the diagram has Every(period), by which a run could keep pace");
  std::int64_t shortest = kForever;
  for (const internal::Rate& rate : rates) shortest = std::min(shortest, rate.period.Times(1));
  return std::max<std::int64_t>(shortest, 1);
}

/// "µ" takes two bytes and one column.
std::string Padded(const std::string& text, std::size_t width) {
  const auto columns = static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
  return std::string(width > columns ? width - columns : 0, ' ') + text;
}

std::string Row(const std::string& name, const std::array<std::string, 4>& columns) {
  std::string row = "\n  " + name + std::string(name.size() < 10 ? 10 - name.size() : 0, ' ');
  for (const std::string& column : columns) row += Padded(column, 10);
  return row;
}

std::string Row(const std::string& name, const TimeHistogram& h) {
  if (h.count() == 0) return "";
  return Row(name, {TimeText(h.Quantile(0.5)), TimeText(h.Quantile(0.99)),
                    TimeText(h.Quantile(0.999)), TimeText(h.worst())});
}

}  // namespace

std::string RunReport::text() const {
  std::string text =
      Text(ticks) + " ticks, " + Text(missed) + " missed, " + Text(skipped) + " skipped";
  if (skipped > 0) text += ": the diagram's clock is " + TimeText(behind) + " behind";
  text += "; " + reason;
  if (ticks > 0) text += Row("", {"median", "99 %", "99.9 %", "worst"});
  text += Row("period", period) + Row("lateness", lateness) + Row("compute", compute);
  for (const std::string& why : refused) text += "\n" + why;
  return text;
}

RealTimeRunner::RealTimeRunner(Simulator& sim, const Options& options)
    : sim_{sim},
      options_{options},
      period_{ShortestPeriod(sim.diagram())},
      catch_up_{options.overrun == Overrun::CatchUp ? options.catch_up : 0},
      times_{options.times ? options.times : std::make_shared<TickTimes>()} {
  Require(options_.catch_up >= 1, "catch_up must be >= 1", options_.catch_up);
  RealTimePermissions::Check(options_.permissions);
}

const RunReport& RealTimeRunner::Run(double end) {
  if (!(end >= sim_.time()))
    throw Error("Run: the end must not lie before the time reached, " + Text(sim_.time()) +
                " s, got " + Text(end));
  report_ = {};
  report_.end = RunEnd::Failed;
  report_.reason = "an exception ended it";
  *times_ = {};
  const RealTimePermissions permissions(options_.permissions);
  report_.refused = permissions.refused();
  report_.end = Loop(Nanoseconds(end));
  const std::string now = "t = " + Text(sim_.time()) + " s";
  if (report_.end == RunEnd::TimeReached) report_.reason = "its end was reached, " + now;
  if (report_.end == RunEnd::Ended) report_.reason = sim_.ended()->text();
  if (report_.end == RunEnd::StopAsked) report_.reason = "it was asked to stop at " + now;
  if (report_.end == RunEnd::Overran)
    report_.reason = "it stopped at " + now + ", since the next tick would begin " +
                     TimeText(report_.lateness.worst()) +
                     " late, which is no less than the period of " +
                     TimeText(1e-9 * static_cast<double>(period_));
  return report_;
}

RunEnd RealTimeRunner::Loop(std::int64_t end) {
  std::int64_t before = -1;                                // when the last tick began
  std::int64_t origin = Now() - Nanoseconds(sim_.time());  // W_k = origin + t_k
  while (!sim_.ended()) {
    const std::int64_t tick = sim_.next_tick_ns();
    if (!WaitFor(origin + std::min(tick, end))) return RunEnd::StopAsked;
    if (tick >= end) {
      sim_.AdvanceTo(1e-9 * static_cast<double>(end));
      return sim_.ended() ? RunEnd::Ended : RunEnd::TimeReached;
    }

    const std::int64_t begin = Now();
    if (options_.paced) {
      const std::int64_t lateness = begin - (origin + tick);
      report_.lateness.Count(lateness);
      times_->lateness_ns = lateness;
      if (lateness >= period_) {
        origin += period_ * Miss(lateness / period_);
        if (options_.overrun == Overrun::Stop) return RunEnd::Overran;
      }
    }
    times_->missed = report_.missed;
    if (before >= 0) report_.period.Count(begin - before);
    before = begin;

    ++report_.ticks;
    if (options_.before_tick) {
      sim_.AdvanceTo(1e-9 * static_cast<double>(tick));
      if (!sim_.ended()) options_.before_tick(sim_, report_);
    }
    sim_.AdvanceThroughTick();
    if (sim_.next_tick_ns() == tick) {  // the run ended on the way there
      --report_.ticks;
      break;
    }
    times_->compute_ns = Now() - begin;
    report_.compute.Count(times_->compute_ns);
  }
  return RunEnd::Ended;
}

/// A tick begins so many periods late. Returns how many of them are skipped.
std::int64_t RealTimeRunner::Miss(std::int64_t periods) {
  if (options_.overrun == Overrun::Stop) {
    report_.missed += periods;
    return 0;
  }
  const std::int64_t skipped = std::max<std::int64_t>(0, periods - catch_up_);
  report_.skipped += skipped;
  report_.behind = 1e-9 * static_cast<double>(report_.skipped * period_);
  report_.missed += skipped + (periods > skipped ? 1 : 0);
  return skipped;
}

/// Whether the run goes on when the wall clock is there.
bool RealTimeRunner::WaitFor(std::int64_t wall) const {
  if (options_.paced) {
    const timespec when{.tv_sec = wall / kSecond, .tv_nsec = wall % kSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr) == EINTR)
      if (AskedToStop()) return false;
  }
  return !AskedToStop();
}

bool RealTimeRunner::AskedToStop() const { return options_.stop && *options_.stop; }

}  // namespace pliant
