#include "pliant/diagrams/friction_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

TEST(Probe, Runs) {
  const char* set = std::getenv("SET");
  ParameterFile file = ParameterFile::ReadText(
      std::string("robot: gen3\n") +
      "station: !SimulatedArm {position: [0, 0, 0, 0, 0, 0, 0], engine: recursive}\n"
      "controller: !FrictionExperiment " + (set ? set : "{}") + "\n"
      "integrator: {method: dormand_prince}\n"
      "duration_s: 1000\n");
  Scenario scenario;
  file.Fill(scenario);
  const auto c = std::get<FrictionExperiment::Options>(ControllerOf(scenario, StationOf(scenario)));
  std::printf("length %g\n", FrictionExperiment::LengthOf(c));
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  FrictionReport last;
  last.joint = -1;
  FILE* csv = std::getenv("CSV") ? std::fopen(std::getenv("CSV"), "w") : nullptr;
  for (int k = 0; k < 1000000; ++k) {
    sim.AdvanceThroughTick();
    const FrictionReport& r = sim.Get(scene.friction->report);
    const JointPosition q = sim.Get(scene.arm->measured_position);
    const JointVelocity v = sim.Get(scene.arm->measured_velocity);
    const JointTorque t = sim.Get(scene.friction->torque);
    const JointPosition ref = sim.Get(scene.friction->reference);
    if (csv && k % 5 == 0)
      std::fprintf(csv, "%g,%d,%d,%d,%g,%g,%g,%g,%g\n", 1e-3 * k, (int)r.phase, r.joint, r.steady,
                   q(r.joint), v(r.joint), t(r.joint), ref(r.joint), (q - ref).cwiseAbs().maxCoeff());
    if (r.phase != last.phase || r.joint != last.joint) {
      std::printf("%8.3f phase %d joint %d stop %d by %d  q %8.4f v %8.4f up %g down %g\n",
                  1e-3 * k, int(r.phase), r.joint, int(r.stop), r.stopped_by, q(r.joint),
                  v(r.joint), sim.Get(scene.friction->break_away_up)(r.joint),
                  sim.Get(scene.friction->break_away_down)(r.joint));
      std::fflush(stdout);
    }
    last = r;
    if (r.phase == FrictionPhase::Done || r.phase == FrictionPhase::Stopped) break;
  }
}

}  // namespace
}  // namespace pliant
