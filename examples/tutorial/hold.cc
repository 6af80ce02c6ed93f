// A Gen3 holds its posture by a damped spring while its forearm is pushed.
//   hold LOG REPORT [FRICTION]   FRICTION: what was identified, in the place of the model's

#include <algorithm>
#include <iostream>

#include "held_arm.h"
#include "pliant/analysis/mcap_log.h"
#include "pliant/analysis/recording.h"
#include "pliant/analysis/report.h"
#include "pliant/diagrams/stations.h"
#include "pliant/plants/friction_file.h"
#include "pliant/plants/shared_file.h"
#include "pliant/systems/simulator.h"

using namespace pliant;

const JointPosition kPosture{0, 0.58, 3.14, -1.84, 0, 0.85, 1.57};
constexpr double kStiffness = 200;  // N·m/rad

// shown: begin report
/// How far the joints gave way, and whether they came back.
Report ReportOn(const Recording& run, const ArmActuators& actuators) {
  const RecordedSignal& position = run["arm.measured_position"];
  const Eigen::MatrixXd error = position.numbers.colwise() - kPosture;
  Panel panel{.x = {.label = "time [s]"},
              .left = {.label = "q − q₀ [rad]"},
              .x_bands = {{.from = 0.5, .to = 1.5, .label = "push"}}};
  for (int j = 0; j < error.rows(); ++j)
    panel.curves.push_back({.label = "joint " + Text(j + 1),
                            .x = {position.times.begin(), position.times.end()},
                            .y = {error.row(j).begin(), error.row(j).end()}});

  const double rest = error.rightCols<1>().cwiseAbs().maxCoeff();
  double stuck = 0;
  for (const ActuatorParameters& joint : actuators.joint)
    stuck = std::max(stuck, joint.friction.stiction / kStiffness);
  return {.title = "A Gen3 on springs",
          .summary = "Seven springs hold the arm, and somebody pushes its forearm.",
          .claims = {{.id = "comes-back",
                      .source = "no paper",
                      .paper = "after the push the joints come back, but for their friction",
                      .measured = Text(rest) + " rad",
                      .criterion = "at most " + Text(stuck) + " rad",
                      .basis = "at rest a spring pulls with at most the static friction, s/K",
                      .holds = rest <= stuck}},
          .figures = {{.name = "error", .panels = {panel}}}};
}
// shown: end report

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::cerr << "hold LOG REPORT [FRICTION]\n";
    return 2;
  }
  // shown: begin run
  const RobotModel model = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  SimulatedArm::Options station = SimulatedGen3(model, {.position = kPosture});
  // shown: end run
  // shown: begin friction
  if (argc > 3)
    station.actuators =
        WithFriction(station.actuators, model.joints(), ReadFriction(argv[3], model.joints()));
  // shown: end friction
  // shown: begin run
  const auto log = std::make_shared<McapLog>(McapLog::Options{.file = argv[1]});
  const HeldArm held = MakeHeldArm(station,
                                   {.model = model,
                                    .posture = kPosture,
                                    .stiffness = PerJoint::Constant(7, kStiffness),
                                    .damping = PerJoint::Constant(7, 10)},
                                   {.model = model,
                                    .link = "forearm_link",
                                    .force = {0, 60, 0},
                                    .start_s = 0.5,
                                    .duration_s = 1},
                                   log);
  Simulator sim{held.diagram, {.integrator = {.method = Method::kDormandPrince}}};
  sim.AdvanceTo(3);
  log->Close();
  WriteReport(ReportOn(Recording::Read(argv[1]), station.actuators), argv[2]);
  // shown: end run
} catch (const Error& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
