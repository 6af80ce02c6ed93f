// The same with an arm of one's own: ideal motors, since nothing is known of its own.
//   hold_my_arm URDF LOG

#include <iomanip>
#include <iostream>

#include "held_arm.h"
#include "pliant/analysis/mcap_log.h"
#include "pliant/systems/simulator.h"

using namespace pliant;

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::cerr << "hold_my_arm URDF LOG\n";
    return 2;
  }
  // shown: begin
  const RobotModel model = RobotModel::FromUrdf(argv[1]);
  const JointPosition posture{0.3, -1.2};
  const auto log = std::make_shared<McapLog>(McapLog::Options{.file = argv[2]});
  const HeldArm held = MakeHeldArm({.model = model, .position = posture},
                                   {.model = model,
                                    .posture = posture,
                                    .stiffness = PerJoint::Constant(2, 50),
                                    .damping = PerJoint::Constant(2, 10)},
                                   {.model = model,
                                    .link = "forearm",
                                    .point = {0, 0, 0.3},
                                    .force = {10, 0, 0},
                                    .start_s = 0.5,
                                    .duration_s = 1},
                                   log);
  Simulator sim{held.diagram};
  std::cout << std::fixed << std::setprecision(3);
  sim.AdvanceTo(1);
  std::cout << "pushed:  " << sim.Get(held.arm.position).transpose() << " rad\n";
  sim.AdvanceTo(3);
  std::cout << "after:   " << sim.Get(held.arm.position).transpose() << " rad\n";
  log->Close();
  // shown: end
} catch (const Error& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
