#include "pliant/analysis/motion_claims.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

constexpr int kRows = 2001;

RecordedSignal Vectors(const std::string& path, const std::vector<std::string>& elements,
                       const std::vector<std::string>& units, const Eigen::MatrixXd& numbers) {
  RecordedSignal signal{{path, path, elements, units}, {}, {}};
  signal.times = Eigen::VectorXd::LinSpaced(kRows, 0, 2);
  signal.numbers = numbers;
  return signal;
}

RunData With(const Eigen::MatrixXd& positions, std::vector<RecordedSignal> more = {}) {
  RunData run;
  run.name = run.title = "run";
  more.push_back(Vectors("tool.position", {"[x]", "[y]", "[z]"}, {"m", "m", "m"}, positions));
  // whose rows are those of the log
  more.push_back(
      Vectors("arm.measured_position", {"[joint_1]"}, {"rad"}, Eigen::MatrixXd::Zero(1, kRows)));
  run.log = Recording(more, {});
  return run;
}

TEST(MovesAlong, ComparesTheWayAlongWithThatAcross) {
  const Eigen::Vector3d d(3, 4, 0), across(-0.8, 0.6, 0);
  Eigen::MatrixXd p(3, kRows);
  for (int k = 0; k < kRows; ++k)
    p.col(k) = Eigen::Vector3d(0.5, 0, 0.4) + (d * 0.02 + across * 0.005) * k / (kRows - 1.0);
  const RunData run = With(p);  // 0.1 m along, 5 mm across
  MovesAlong claim{.claim = {.id = "id", .source = "s", .paper = "p"},
                   .basis = "b",
                   .run = "run",
                   .direction = d,
                   .part = 0.0501,
                   .at_least = 0.0999};
  EXPECT_TRUE(claim.Check(Runs({&run})).holds);
  EXPECT_EQ(claim.Check(Runs({&run})).measured, "100 mm along, 5.00 mm across");
  claim.part = 0.0499;
  EXPECT_FALSE(claim.Check(Runs({&run})).holds);
  claim.part = 0.1;
  claim.at_least = 0.1001;
  EXPECT_FALSE(claim.Check(Runs({&run})).holds);
  claim.direction.setZero();
  const Scenario scenario;
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }),
            "the length of direction must be > 0, got 0");
}

/// A handle at 0.4 m about an upright hinge through (0.1, 0, ·), turned by a force of 10 N along y
/// at the tool of an arm that is at rest elsewhere, by closed form: I θ̈ = τ_h with τ_h constant.
struct Door {
  explicit Door(double inertia) {
    const RobotModel model = Gen3();
    const JointPosition q{0, 0.2618, 3.1416, -2.2689, 0, 0.9599, 1.5708};
    RobotDynamics d(model, {"tool_frame"});
    ComputeDynamics(model, q, JointVelocity::Zero(model.joints()), d);
    const Eigen::Vector3d tool = d.frame[0].pose.position, hinge(tool.x() - 0.4, tool.y(), 0);
    const double moment = 0.4 * 10;  // of the push, which stays where the arm is
    Eigen::MatrixXd p(3, kRows), twist = Eigen::MatrixXd::Zero(6, kRows);
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(3, kRows);
    Eigen::MatrixXd joints(7, kRows);
    for (int k = 0; k < kRows; ++k) {
      const double t = 2.0 * k / (kRows - 1), rate = moment / inertia * t;
      const double theta = 0.5 * rate * t;
      p.col(k) = Eigen::Vector3d(hinge.x() + 0.4 * std::cos(theta),
                                 hinge.y() + 0.4 * std::sin(theta), tool.z());
      twist.col(k).tail<3>() = 0.4 * rate * Eigen::Vector3d(-std::sin(theta), std::cos(theta), 0);
      force(1, k) = 10;
      joints.col(k) = q;
    }
    std::vector<std::string> names, units;
    for (int i = 0; i < model.size(); ++i) {
      names.push_back("[" + model.joint(i).name + "]");
      units.emplace_back("rad");
    }
    run = With(p, {Vectors("tool.twist", {"[wx]", "[wy]", "[wz]", "[vx]", "[vy]", "[vz]"},
                           {"rad/s", "rad/s", "rad/s", "m/s", "m/s", "m/s"}, twist),
                   Vectors("push_1.force", {".force[x]", ".force[y]", ".force[z]"}, {"N", "N", "N"},
                           force),
                   Vectors("arm.position", names, units, joints)});
    ComplianceControl::Options made;
    made.model = model;
    made.tool = "tool_frame";
    run.control = made;
    VirtualDoor::Options door;
    door.hinge = hinge;
    door.axis = {0, 0, 2};
    door.inertia = 5;
    ComplianceControl::Options control;
    control.door = door;
    run.scenario.controller = control;
    Push::Options push;
    push.link = "tool_frame";
    push.force = {0, 10, 0};
    push.start_s = -10;
    push.duration_s = 20;
    run.scenario.environment = {push};
  }
  Claim Check(double off_circle) const {
    const KeepsDoor claim{
        .claim = {.id = "id", .source = "s", .paper = "p"}, .run = "run", .off_circle = off_circle};
    return claim.Check(Runs({&run}));
  }
  RunData run;
};

TEST(KeepsDoor, FindsTheInertiaOfADoor) {
  for (const auto& [inertia, holds] :
       {std::pair{5.0, true}, {5.24, true}, {5.26, false}, {4.76, true}, {4.74, false}})
    EXPECT_EQ(Door(inertia).Check(1e-9).holds, holds) << inertia;
}

TEST(KeepsDoor, SeesAHandleThatLeavesItsCircle) {
  Door door(5);
  Eigen::MatrixXd p = door.run["tool.position"];
  p(2, 1000) += 2e-3;
  std::vector<RecordedSignal> signals = door.run.log.signals();
  for (RecordedSignal& signal : signals)
    if (signal.path == "tool.position") signal.numbers = p;
  door.run.log = Recording(signals, {});
  EXPECT_TRUE(door.Check(2.1e-3).holds);
  EXPECT_FALSE(door.Check(1.9e-3).holds);
}

TEST(KeepsDoor, RefusesRunsWithoutADoorWithStopsAndWithoutAPush) {
  const KeepsDoor claim{.claim = {}, .run = "run", .off_circle = 1};
  Door door(5);
  Scenario scenario = door.run.scenario;
  scenario.environment.clear();
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }),
            "there is no !Push in the environment of its run");
  std::get<ComplianceControl::Options>(scenario.controller).door->stops = VirtualDoor::Stops{};
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }),
            "the door of its run has stops, which no balance of moments knows");
  scenario.controller = ComplianceControl::Options{};
  EXPECT_EQ(ErrorOf([&] { claim.RequireFit(scenario); }), "the controller of its run has no door");
}

}  // namespace
}  // namespace pliant
