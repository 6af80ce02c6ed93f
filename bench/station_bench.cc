// What a simulated second costs: a Gen3 in a closed loop with a joint-space controller at 1 kHz.

#include <benchmark/benchmark.h>

#include <numbers>

#include "pliant/diagrams/stations.h"
#include "pliant/diagrams/sway_loop.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

const JointPosition kHome{0, 0.2618, std::numbers::pi, -2.2689, 0, 0.9599, std::numbers::pi / 2};

void Second(benchmark::State& state, bool ideal, SimbodyPlant::Engine engine, Method method) {
  SimulatedArm::Options arm = SimulatedGen3(RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf")),
                                            {.position = kHome, .ideal = ideal, .engine = engine});
  if (!ideal) arm.firmware.mode = ControlMode::Current;
  const SwayLoop loop({.arm = arm});
  Simulator sim(loop.diagram, {.integrator = {.method = method}});
  sim.AdvanceTo(0.5);  // the gears have settled
  const std::int64_t before = sim.statistics().derivative_calls;
  const double start = sim.time();
  for (auto _ : state) sim.AdvanceTo(sim.time() + 1);
  const double ticks = 1000 * (sim.time() - start);
  state.counters["rhs_per_tick"] =
      static_cast<double>(sim.statistics().derivative_calls - before) / ticks;
}

using Engine = SimbodyPlant::Engine;
#define PLIANT_SECOND(name, ideal, engine, method)                       \
  BENCHMARK_CAPTURE(Second, name, ideal, Engine::engine, Method::method) \
      ->Unit(benchmark::kMillisecond)
PLIANT_SECOND(ideal_recursive, true, Recursive, kBogackiShampine);
PLIANT_SECOND(ideal_simbody, true, Simbody, kBogackiShampine);
PLIANT_SECOND(full_recursive_bogacki_shampine, false, Recursive, kBogackiShampine);
PLIANT_SECOND(full_recursive_cash_karp, false, Recursive, kCashKarp);
PLIANT_SECOND(full_recursive_dormand_prince, false, Recursive, kDormandPrince);
PLIANT_SECOND(full_simbody_cash_karp, false, Simbody, kCashKarp);

}  // namespace
}  // namespace pliant
