#include "pliant/analysis/run_log.h"

#include <cmath>
#include <optional>

#include "pliant/plants/parameter_text.h"

namespace pliant {

namespace {

constexpr double kRoundOff = 1e-9;  // of times [s], ticks being whole nanoseconds, and of periods

std::int64_t TicksBefore(double t, Duration period) {
  return std::llround(std::ceil(t / seconds(period) - kRoundOff));
}

bool IsAtTick(const Simulator& sim, Duration period) {
  const double t = sim.time();
  return std::abs(static_cast<double>(TicksBefore(t, period)) * seconds(period) - t) < kRoundOff;
}

/// Whether what ticks at the time that was reached has done so.
bool IsThroughTick(const Simulator& sim) {
  return sim.next_tick_ns() > std::llround(1e9 * sim.time());
}

}  // namespace

McapLog::Options RunLogOf(const RunLog& log) {
  return {.file = log.file,
          .force = log.force,
          .metadata = {{"pliant",
                        {{"version", PLIANT_VERSION},
                         {"built_with", PLIANT_BUILT_WITH},
                         {"experiment", log.experiment},
                         {"scenario", ParametersText(log.scenario)},
                         {"run", log.run.name},
                         {"title", log.run.title},
                         {"repetition", std::to_string(log.repetition)},
                         {"seed", std::to_string(log.scenario.seed)}}}},
          .robot = RobotOf(log.scenario),
          .robot_description = UrdfTextOf(log.scenario),
          .position = "arm.measured_position",
          .velocity = "arm.measured_velocity",
          .torque = "arm.measured_torque"};
}

std::map<std::string, std::string> RunEndOf(const Simulator& sim, bool whole, double wall_s,
                                            std::int64_t ticks) {
  const Simulator::Statistics statistics = sim.statistics();
  std::map<std::string, std::string> told{
      {"whole", whole ? "1" : "0"},
      {"simulated_s", internal::YamlText(sim.time())},
      {"wall_s", internal::YamlText(wall_s)},
      {"ticks", std::to_string(ticks)},
      {"integrator_steps", std::to_string(statistics.steps)},
      {"derivative_calls", std::to_string(statistics.derivative_calls)},
      {"integrator", statistics.text()}};
  if (const std::optional<Simulator::Ending> ending = sim.ended()) told["ended"] = ending->text();
  return told;
}

bool TickAtEnd(Simulator& sim, double duration_s, Duration period) {
  if (std::abs(sim.time() - duration_s) > kRoundOff || sim.ended() || !IsAtTick(sim, period) ||
      IsThroughTick(sim))
    return false;
  sim.AdvanceThroughTick();
  return true;
}

std::int64_t TicksOf(const Simulator& sim, Duration period) {
  return TicksBefore(sim.time(), period) + (IsAtTick(sim, period) && IsThroughTick(sim));
}

}  // namespace pliant
