// A kilogram and a quarter falls on a rope that hangs from a Gen3 in position mode: how far does
// the tool give way?

#include <algorithm>
#include <cmath>
#include <iostream>

#include "pliant/diagrams/stations.h"
#include "pliant/plants/mass_on_rope.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/simulator.h"

using namespace pliant;

int main() {
  const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  const JointPosition extended{0, 0.58, 3.14, -1.84, 0, 0.85, 1.57};
  RobotDynamics start(model, {"tool_frame"});
  ComputeDynamics(model, extended, JointVelocity::Zero(model.joints()), start);
  const Eigen::Vector3d tool = start.frame[0].pose.position;

  // shown: begin
  SimulatedArm::Options station = SimulatedGen3(model, {.position = extended});
  station.firmware.mode = ControlMode::Position;

  DiagramBuilder b;
  auto& arm = b.Add<SimulatedArm>("arm", station);
  auto& mass = b.Add<MassOnRope>("mass", {.model = model,
                                          .link = "tool_frame",
                                          .mass = 1.25,
                                          .length = 0.25,
                                          .stiffness = 2e4,
                                          .damping = 50,
                                          .position = tool,
                                          .release = 500ms});
  b.Connect(arm.motion, mass.motion);
  b.Connect(mass.contact, arm.contacts);
  // shown: end
  const Diagram diagram = b.Build();

  Simulator sim{diagram, {.integrator = {.method = Method::kDormandPrince}}};
  double deflection = 0, tension = 0;
  while (sim.time() < 2) {
    sim.AdvanceThroughTick();
    const Eigen::Vector3d now =
        MotionOf(model, sim.Get(arm.motion), model.link_index("tool_frame"), {0, 0, 0}).position;
    deflection = std::max(deflection, (now - tool).norm());
    tension = std::max(tension, sim.Get(mass.tension));
  }
  std::cout << "the rope pulls with up to " << std::round(tension) << " N, at 2 s with "
            << std::round(sim.Get(mass.tension)) << " N\nthe tool gives way by "
            << std::round(1e4 * deflection) / 10 << " mm at most, joint_4 draws "
            << std::round(10 * sim.Get(arm.measured_current)(3)) / 10 << " A\n";
}
