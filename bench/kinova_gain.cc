// The largest gain k at which Kinova's torque loop is stable on a simulated Gen3: elastic gears,
// friction, noisy sensors, the arm held in an extended posture by a controller that is compliant in
// the null space. Forearm and tool are pushed by 20 N, so that no joint just sticks, and left alone
// for a second and a half.
//
//   kinova_gain [DAMPING]
//
// For f = 0 and 1 it prints how fast the links move on average over the last second of three, for
// k that grow by √2, then both ends of the stable range, to 2 %: a weak loop without a feedforward
// is too slow for the controller around it. Unstable is what moves by more than 0.02 rad/s, or what
// a motor's current is cut for; a held arm moves by 0.001.

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "pliant/diagrams/scenario.h"
#include "pliant/systems/simulator.h"

namespace pliant {
namespace {

struct Held {
  double speed = 0;  ///< rms of the links' velocities, all joints [rad/s]
  double error = 0;  ///< rms of the torque error, all joints [N·m]
  double tool = 0;   ///< how far off the tool is at the end [m]
  int cut = 0;       ///< ticks at which a current was cut
  bool stable() const { return speed < 0.02 && cut == 0; }
};

Held Hold(const TorqueLoopChoice& loop) {
  ComplianceControl::Options control;
  control.tool = "tool_frame";
  control.posture.compliance = JointMatrix::Constant(1, 1, 1);
  control.torque_loop = loop;
  Scenario scenario;
  scenario.robot = "gen3";
  scenario.station = StationOptions{.position = {0, 0.58, 3.14, -1.84, 0, 0.85, 1.57},
                                    .engine = SimbodyPlant::Engine::Recursive};
  scenario.controller = control;
  for (const char* link : {"forearm_link", "tool_frame"}) {
    Push::Options push;
    push.link = link;
    push.force = {0, 20, 0};
    push.start_s = 0.5;
    push.duration_s = 1;
    scenario.environment.emplace_back(push);
  }
  scenario.duration_s = 3;
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  Held held;
  try {
    for (int k = 0; k < 3000; ++k) {
      sim.AdvanceThroughTick();
      const double speed = sim.Get(scene.arm->velocity).norm();
      if (!(speed < 5)) throw Error("it runs away");
      if (k < 2000) continue;
      held.speed += speed * speed / 1000;
      held.error += sim.Get(scene.control->torque_error).squaredNorm() / 1000;
      held.cut += sim.Get(scene.control->saturated) != 0;
    }
    held.tool = sim.Get(scene.control->pose_error).tail<3>().norm();
  } catch (const Error&) {
    held.speed = held.error = held.tool = INFINITY;
  }
  held.speed = std::sqrt(held.speed);
  held.error = std::sqrt(held.error);
  return held;
}

Held Show(double f, double k, double d) {
  const Held held = d > 0 ? Hold(KinovaDampedLoop{.feedforward = f, .gain = k, .damping = d})
                          : Hold(KinovaHighVelocityLoop{.feedforward = f, .gain = k});
  std::printf("%4.1f %8.3f  %9.5f rad/s  %8.3f N·m  %7.4f m  %4d  %s\n", f, k, held.speed,
              held.error, held.tool, held.cut, held.stable() ? "stable" : "unstable");
  std::fflush(stdout);
  return held;
}

}  // namespace
}  // namespace pliant

int main(int argc, char** argv) {
  const double damping = argc > 1 ? std::atof(argv[1]) : 0;
  std::printf("d = %g N·m·s/rad\n   f        k   links         torque error  tool      cut\n",
              damping);
  const auto stable = [&](double f, double k) { return pliant::Show(f, k, damping).stable(); };
  for (const double f : {0.0, 1.0}) {
    double k = 0.5;
    while (k < 300 && !stable(f, k)) k *= std::sqrt(2.0);
    double least = k, most = k, below = k / std::sqrt(2.0);
    while (k < 300 && stable(f, k *= std::sqrt(2.0))) most = k;
    while (k / most > 1.02) (stable(f, std::sqrt(k * most)) ? most : k) = std::sqrt(k * most);
    if (least > 0.5)
      while (least / below > 1.02)
        (stable(f, std::sqrt(below * least)) ? least : below) = std::sqrt(below * least);
    std::printf("f = %g, d = %g: stable from k = %.3g to %.3g\n", f, damping, least, most);
  }
}
