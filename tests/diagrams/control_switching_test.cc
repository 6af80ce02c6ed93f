#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "pliant/diagrams/scenario.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr int kSwitch = 600;  // the tick of the change

struct Case {
  bool ideal, pushed, dynamic;
  ComplianceMode mode;
};

Scenario Changing(const Case& c, ArmControl from, ArmControl to) {
  ComplianceControl::Options control;
  control.tool = "FT_sensor_wrench";
  control.estimate = TorqueEstimate::Fusion;
  control.modes = {.mode = c.mode,
                   .dynamic = c.dynamic,
                   .control = from,
                   .kinova_loop = KinovaDampedLoop{.feedforward = 1, .gain = 15, .damping = 0},
                   .changes = {{.at_s = 1e-3 * kSwitch, .control = to}}};
  Scenario scenario;
  scenario.robot = "gen3_bota";
  scenario.station = StationOptions{.ideal = c.ideal, .engine = SimbodyPlant::Engine::Recursive};
  scenario.controller = control;
  if (c.pushed) {
    Push::Options push;
    push.link = "FT_sensor_wrench";
    push.force = {0, 15, -20};
    push.start_s = 0.1;
    push.duration_s = 0.8;
    scenario.environment = {push};
  }
  scenario.duration_s = 4;
  return scenario;
}

/// What a run does from the tick before the change on.
struct Ran {
  Ran(const Scenario& scenario, int ticks) {
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    sim.AdvanceTo(1e-3 * (kSwitch - 1));
    const long before = Allocations();
    const PerJoint kappa = StationOf(scenario).actuators.torque_per_ampere();
    PerJoint last;
    for (int k = -1; k < ticks; ++k) {
      sim.AdvanceThroughTick();
      const PerJoint now = kappa.cwiseProduct(sim.Get(scene.arm->measured_current));
      if (k >= 0) jumps.push_back((now - last).cwiseAbs().maxCoeff());
      last = now;
      tool.push_back(sim.Get(scene.arm->motion).frame[0].pose.position);
      if (arrived < 0 &&
          sim.Get(scene.control->arm_control) !=
              std::get<ComplianceControl::Options>(scenario.controller).modes->control)
        arrived = k;
    }
    allocations = Allocations() - before;
  }
  std::vector<double> jumps;          ///< of the motors' torque at each tick [N·m]
  std::vector<Eigen::Vector3d> tool;  ///< its position
  int arrived = -1;                   ///< ticks after the change was wanted; −1: not
  long allocations = 0;
};

TEST(ControlSwitching, Numbers) {
  using enum ArmControl;
  for (const bool ideal : {true, false})
    for (const bool pushed : {false, true})
      for (const bool dynamic : {false, true})
        for (const auto mode :
             {ComplianceMode::NullSpace, ComplianceMode::FullBody, ComplianceMode::Dual}) {
          const Case c{ideal, pushed, dynamic, mode};
          for (const ArmControl from : {Position, KinovaTorque, ProposedTorque}) {
            const Ran stays(Changing(c, from, from), 300);
            const double usual = *std::ranges::max_element(stays.jumps);
            for (const ArmControl to : {Position, KinovaTorque, ProposedTorque}) {
              if (from == to) continue;
              const Ran ran(Changing(c, from, to), to == Position ? 3000 : 1000);
              const auto worst = std::ranges::max_element(ran.jumps);
              double off = 0;
              for (std::size_t k = 0; k < stays.tool.size(); ++k)
                off = std::max(off, (ran.tool[k] - stays.tool[k]).norm());
              std::printf(
                  "%s %s %s %d: %d -> %d usual %.3f first %.3f worst %.3f at %d arrived %d off "
                  "%.4f total %.4f alloc %ld\n",
                  ideal ? "ideal" : "full", pushed ? "pushed" : "rest", dynamic ? "dyn" : "stat",
                  int(mode), int(from), int(to), usual, std::max(ran.jumps[0], ran.jumps[1]),
                  *worst, int(worst - ran.jumps.begin()), ran.arrived, off,
                  (ran.tool.back() - ran.tool.front()).norm(), ran.allocations);
              std::fflush(stdout);
            }
          }
        }
}

}  // namespace
}  // namespace pliant
