// What a simulated second costs: a Gen3 in a closed loop at 1 kHz, with a joint-space controller,
// or with the compliance controller and a mass that is dropped on a rope.

#include <benchmark/benchmark.h>

#include <numbers>

#include "pliant/diagrams/scenario.h"
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

/// The arm stands compliant in its null space; 1 kg falls 0.25 m until its rope to the forearm
/// catches it, and swings. Four seconds, without a log.
void Drop(benchmark::State& state, bool ideal, SimbodyPlant::Engine engine, Method method) {
  StationOptions station;
  station.position = kHome;
  station.ideal = ideal;
  station.engine = engine;
  ComplianceControl::Options control;
  control.tool = "tool_frame";
  control.posture.compliance = JointMatrix::Identity(7, 7);
  const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  RobotDynamics at(model, {"forearm_link"});
  ComputeDynamics(model, kHome, JointVelocity::Zero(model.joints()), at);
  MassOnRope::Options rope;
  rope.link = "forearm_link";
  rope.mass = 1;
  rope.length = 0.3;
  rope.stiffness = 4000;
  rope.damping = 20;
  rope.position = at.frame[0].pose.position + Eigen::Vector3d(0.02, 0, -0.05);
  rope.release = 500ms;
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.station = station;
  scenario.controller = control;
  scenario.environment = {rope};
  scenario.integrator.method = method;
  scenario.duration_s = 4;
  ScenarioDiagram parts(scenario);
  const Diagram diagram = parts.builder.Build();
  for (auto _ : state) {
    Simulator sim(diagram, {.integrator = scenario.integrator});
    sim.AdvanceTo(scenario.duration_s);
    state.counters["derivatives_per_tick"] =
        static_cast<double>(sim.statistics().derivative_calls) / (1000 * scenario.duration_s);
  }
  // of real time, per second of a core
  state.counters["speed"] = benchmark::Counter(
      scenario.duration_s * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["per_second_ns"] =
      benchmark::Counter(1e-9 * scenario.duration_s * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
#define PLIANT_DROP(name, ideal, engine, method)                       \
  BENCHMARK_CAPTURE(Drop, name, ideal, Engine::engine, Method::method) \
      ->Unit(benchmark::kMillisecond)
PLIANT_DROP(ideal_recursive, true, Recursive, kBogackiShampine);
PLIANT_DROP(ideal_simbody, true, Simbody, kBogackiShampine);
PLIANT_DROP(full_recursive_cash_karp, false, Recursive, kCashKarp);
PLIANT_DROP(full_simbody_cash_karp, false, Simbody, kCashKarp);

}  // namespace
}  // namespace pliant
