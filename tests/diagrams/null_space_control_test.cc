#include "pliant/diagrams/null_space_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/constant.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/plants/arms.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;

const std::string kText = R"(robot: lwr
station: !SimulatedArm {engine: recursive}
controller: !NullSpaceCompliance
  tool: end_effector_link
  motion: !Circle
    {radius: 0.1, angular_velocity: 0.5, radial_gain: 4, height_gain: 13}
integrator: {method: dormand_prince}
duration_s: 8
)";

Scenario ScenarioIn(const Overrides& set = {}) {
  ParameterFile file = ParameterFile::ReadText(kText, "s.yaml");
  for (const auto& [path, yaml] : set) file.Set(path, yaml, "--set " + path);
  Scenario scenario;
  file.Fill(scenario);
  return scenario;
}

std::string ErrorOfSetting(const Overrides& set) {
  return ErrorOf([&] { ScenarioDiagram(ScenarioIn(set)).builder.Build(); });
}

/// Seen from a time on.
struct Course {
  double off_path = 0, off_turn = 0, joints = 0;
  double missing = 0;         ///< of a wrench of the tool, by the torque that the motors leave out
  double least_singular = 1;  ///< of the tool's Jacobian
  double way = 0;             ///< of the point of the path that the tool goes by
  bool fell = false;          ///< back, at any time
};

Course CourseOf(const Overrides& set, double from_s = 5) {
  const Scenario scenario = ScenarioIn(set);
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  const NullSpaceControl& control = *scene.null_space;
  Course course;
  Eigen::Vector3d last = sim.Get(control.target);
  while (sim.time() < scenario.duration_s) {
    sim.AdvanceThroughTick();
    const Eigen::Vector3d now = sim.Get(control.target);
    const double step = (now - last).norm();
    last = now;
    course.fell = course.fell || sim.Get(control.fallback);
    if (sim.time() < from_s) continue;
    const double singular = sim.Get(control.least_singular);
    course.way += step;
    course.off_path = std::max(course.off_path, sim.Get(control.path_error).norm());
    course.off_turn = std::max(course.off_turn, sim.Get(control.orientation_error).norm());
    course.joints = std::max(course.joints, sim.Get(scene.arm->velocity).norm());
    course.missing = std::max(course.missing, sim.Get(control.torque_error).norm() / singular);
    course.least_singular = std::min(course.least_singular, singular);
  }
  return course;
}

const Overrides kIdeal{{"station.ideal", "true"}, {"controller.orientation.damping", "[1, 1, 1]"}};

Overrides With(Overrides set, const Overrides& more) {
  set.insert(set.end(), more.begin(), more.end());
  return set;
}

// An arm without friction follows the field but for the inertia it does not know of. With all of
// its 16 kg at the tool, ρ ω² = 0.025 m/s² takes 0.4 N: of D k_p k_ρ = 640 N/m 0.6 mm. 0.3 m off
// the wrist it turns the tool with 0.12 N·m: of K_ω 8 mrad.
TEST(NullSpaceControl, DrawsTheCircleWithAnIdealArm) {
  const Course course = CourseOf(kIdeal);
  EXPECT_LT(course.off_path, 1e-3);
  EXPECT_LT(course.off_turn, 0.01);
  EXPECT_FALSE(course.fell);
}

TEST(NullSpaceControl, GoesEveryWayThatIsOffered) {
  for (const auto& [motion, off] : std::vector<std::pair<std::string, double>>{
           // 16 kg (0.1 + 0.08) m ω², of 320 N/m: 2.3 mm
           {"!LimitCycle {radius: 0.08, harmonics: [{}, {cosine: 0.02}], angular_velocity: 0.5,"
            " radial_gain: 2, height_gain: 10}",
            3e-3},
           // 0.11 m e^{−(5 − 1.2)}, 1.2 s being what 0.1 m/s takes longer, and a part 16 kg 1 1/s
           // of
           // D_z k_p = 40 N·s/m late, 1/(1 − 0.4): 4 mm
           {"!Goal {goal: [0.05, 0.08, 0.05], gain: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], speed: 0.1}",
            5e-3},
           // 0.1 m (|K + iωD|/|K − mω² + iωD| − 1), 16 kg and, of rotors, 2.3 kg·m² over (0.55 m)²,
           // 7.6 kg: 15 mm
           {"!Classical {position: [0.1, 0, 0], center: [0, 0, 0], normal: [0, 0, 1], speed: 0.5}",
            0.016}}) {
    const Course course = CourseOf(With(kIdeal, {{"controller.motion", motion}}));
    EXPECT_LT(course.off_path, off) << motion;
  }
}

TEST(NullSpaceControl, CommandsGravityAndBothParts) {
  const Scenario scenario = ScenarioIn();
  ScenarioDiagram scene(scenario);
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram, {.integrator = scenario.integrator});
  for (int i = 0; i < 100; ++i) sim.AdvanceThroughTick();
  const NullSpaceControl& control = *scene.null_space;
  const RobotModel model = RobotOf(scenario);
  RobotDynamics d(model);
  ComputeDynamics(model, sim.Get(scene.arm->measured_position),
                  sim.Get(scene.arm->measured_velocity), d);
  const PerJoint sum = PerJoint(d.gravity) + PerJoint(sim.Get(control.tool_torque)) +
                       PerJoint(sim.Get(control.null_space_torque));
  EXPECT_LT((sim.Get(control.torque) - sum).norm(), 1e-12);
  EXPECT_GT(sim.Get(control.tool_torque).norm(), 0.1);
}

/// The joints' Coulomb and viscous friction at 0.25 rad/s [N·m]: models/lwr/actuators.yaml.
const PerJoint kFriction = JointTorque{0.75, 1.1, 0.625, 0.5, 0.325, 0.175, 0.1};

// Friction asks of the tool for a wrench of at most ‖τ_f‖/σ, σ the least singular value of J, and
// of D k_p k_ρ = 640 and D k_p k_P = 520 N/m for a way. Joints turn with what takes the tool round,
// 0.05 m/s/σ, and as much again in the null space.
TEST(NullSpaceControl, RunsWithEveryNullSpacePart) {
  for (const std::string part :
       {"!None {}", "!Printed {}", "!Meant {}", "!Observer {}", "!Observer {tool_gain: 1}",
        "!Observer {null_space_gain: 0, tool_gain: 1, stiffness: 10}", "!LeastSquares {}",
        "!LeastSquares {at: {link: link_4}}"}) {
    const Course course = CourseOf(
        {{"controller.null_space", part}, {"controller.start_s", "1"}, {"duration_s", "7"}});
    EXPECT_LT(course.off_path, 0.6e-3 + kFriction.norm() / course.least_singular / 520) << part;
    EXPECT_LT(course.joints, 2 * 0.05 / course.least_singular) << part;
    EXPECT_FALSE(course.fell) << part;
  }
}

// The torque that its motors leave out asks of the tool for a wrench: of 520 N/m for a way, of 40
// N·m/rad for a turn. An arm of 8 kg on 5 cm adds 0.1 N.
TEST(NullSpaceControl, DrivesTheMotorsOfAGen3) {
  const Course course = CourseOf({{"robot", "gen3"},
                                  {"controller.tool", "tool_frame"},
                                  {"controller.motion.radius", "0.05"},
                                  {"controller.orientation.damping", "[1, 1, 1]"},
                                  {"controller.orientation.stiffness", "[40, 40, 40]"}});
  EXPECT_LT(course.off_path, 0.2e-3 + course.missing / 520);
  EXPECT_LT(course.off_turn, 1e-3 + course.missing / 40);
  EXPECT_FALSE(course.fell);
}

// examples/circling_arm.yaml before its hand, 3 s at 1 rad/s on 6 to 8 cm; its D k_p is 160 N·s/m,
// and its least stiffness D_z k_p k_P = 200 N/m.
TEST(NullSpaceControl, TakesAGen3RoundTheOvalOfTheExample) {
  const Course course =
      CourseOf({{"robot", "gen3"},
                {"controller.tool", "tool_frame"},
                {"controller.motion",
                 "!LimitCycle {radius: 0.07, harmonics: [{}, {cosine: -0.01}],"
                 " angular_velocity: 1, radial_gain: 2, height_gain: 5}"},
                {"controller.orientation", "{stiffness: [40, 40, 40], damping: [2, 2, 2]}"},
                {"controller.null_space", "!Printed {damping_gain: 2}"}});
  EXPECT_LT(course.off_path, 3e-3 + course.missing / 200);
  EXPECT_GT(course.way, 3 * (0.06 - course.missing / 160));
  EXPECT_LT(course.way, 3 * (0.085 + course.missing / 160));
  EXPECT_FALSE(course.fell);
}

// Nobody pushes and the model is that of the arm, so the mean of an estimate over a second is that
// of the sensors' offsets, 1.4 N·m, or what is left of them: the mean of a second of their noise.
TEST(NullSpaceControl, WaitsAndThenEstimatesWithoutTheOffsetOfTheSensors) {
  for (const std::string part : {"!Observer {}", "!LeastSquares {}"}) {
    const auto estimate = [&](double start_s) {
      const Scenario scenario =
          ScenarioIn({{"controller.null_space", part}, {"controller.start_s", Text(start_s)}});
      ScenarioDiagram scene(scenario);
      const Diagram diagram = scene.builder.Build();
      Simulator sim(diagram, {.integrator = scenario.integrator});
      const NullSpaceControl& control = *scene.null_space;
      while (sim.time() < 1.99) {
        sim.AdvanceThroughTick();
        if (start_s > 0) {
          EXPECT_EQ(sim.Get(control.desired).norm(), 0);
          EXPECT_EQ(sim.Get(control.external_torque).norm(), 0);
          EXPECT_EQ(sim.Get(control.storage), 0);
        }
      }
      while (sim.time() < 2.02) sim.AdvanceThroughTick();
      EXPECT_GT(sim.Get(control.desired).norm(), 0);
      EXPECT_GT(sim.Get(control.storage), 0);
      JointTorque sum = 0 * sim.Get(control.external_torque);
      int samples = 0;
      while (sim.time() < 5) sim.AdvanceThroughTick();
      for (; sim.time() < 6; ++samples) {
        sim.AdvanceThroughTick();
        sum += sim.Get(control.external_torque);
      }
      return sum.norm() / samples;
    };
    EXPECT_LT(estimate(2), 0.5 * estimate(0)) << part;
  }
}

/// An LWR that is measured as it is told, under the law.
struct Told {
  explicit Told(NullSpaceControl::Options o = {}) {
    o.model = Lwr();
    o.position = start;
    o.period = 5ms;
    o.tool = "end_effector_link";
    o.motion = CircleGenerator::Options{
        .radius = 0.1, .angular_velocity = 0.5, .radial_gain = 4, .height_gain = 13};
    o.fallback_damping = 3;
    const Joints& joints = o.model.joints();
    limit = o.model.effort_limit();
    gravity.resize(joints.size());
    DiagramBuilder b;
    q = &b.Add<Constant<JointPosition>>("q", {.space = joints, .value = start});
    v = &b.Add<Constant<JointVelocity>>("v",
                                        {.space = joints, .value = JointVelocity::Zero(joints)});
    auto& tau =
        b.Add<Constant<JointTorque>>("tau", {.space = joints, .value = JointTorque::Zero(joints)});
    control = &b.Add<NullSpaceControl>("control", o);
    b.Connect(q->y, control->measured_position);
    b.Connect(v->y, control->measured_velocity);
    b.Connect(tau.y, control->measured_torque);
    diagram.emplace(b.Build());
    sim.emplace(*diagram);
    RobotDynamics d(o.model);
    ComputeDynamics(o.model, start, JointVelocity::Zero(joints), d);
    gravity = d.gravity;
  }
  PerJoint Torque() {
    sim->AdvanceThroughTick();
    return sim->Get(control->torque);
  }

  const JointPosition start{0, 0.7, 0, -1.57, 0, 0.87, 0};
  PerJoint gravity, limit;
  Constant<JointPosition>* q;
  Constant<JointVelocity>* v;
  NullSpaceControl* control;
  std::optional<Diagram> diagram;
  std::optional<Simulator> sim;
};

TEST(NullSpaceControl, FallsBackToGravityAndDampingAndStays) {
  Told arm;
  arm.Torque();
  EXPECT_FALSE(arm.sim->Get(arm.control->fallback));
  PerJoint v = PerJoint::Constant(7, 0.2);
  v(3) = std::numeric_limits<double>::quiet_NaN();
  arm.sim->Set(arm.v->value, JointVelocity(v));
  PerJoint expected = arm.gravity - 3 * v;
  expected(3) = 0;
  EXPECT_LT((arm.Torque() - expected).norm(), 1e-12);
  EXPECT_TRUE(arm.sim->Get(arm.control->fallback));
  v(3) = 0.2;  // the derivative of the velocity error remembers
  arm.sim->Set(arm.v->value, JointVelocity(v));
  EXPECT_LT((arm.Torque() - (arm.gravity - 3 * v)).norm(), 1e-12);
  EXPECT_TRUE(arm.sim->Get(arm.control->fallback));
  JointPosition nowhere = arm.start;
  nowhere(0) = std::numeric_limits<double>::quiet_NaN();
  arm.sim->Set(arm.q->value, nowhere);
  EXPECT_TRUE(arm.Torque().allFinite());
}

TEST(NullSpaceControl, KeepsTheLimitsOfTheJoints) {
  NullSpaceControl::Options stiff;
  stiff.damping = {4000, 4000, 4000};
  Told arm(stiff);
  const PerJoint tau = arm.Torque();
  EXPECT_LE((tau.cwiseAbs() - arm.limit).maxCoeff(), 0) << tau.transpose();
  JointBits cut = 0;
  for (int j = 0; j < 7; ++j)
    if (std::abs(tau(j)) == arm.limit(j)) cut |= JointBits{1} << j;
  EXPECT_NE(cut, 0U);
  EXPECT_EQ(arm.sim->Get(arm.control->saturated), cut);
  EXPECT_FALSE(arm.sim->Get(arm.control->fallback));
}

TEST(NullSpaceControl, RunsOffTheHeap) {
  for (const std::string part : {"!Meant {}", "!LeastSquares {at: {link: link_4}}"}) {
    const Scenario scenario = ScenarioIn({{"controller.null_space", part}});
    ScenarioDiagram scene(scenario);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    for (int i = 0; i < 10; ++i) sim.AdvanceThroughTick();
    const long before = Allocations();
    for (int i = 0; i < 100; ++i) sim.AdvanceThroughTick();
    EXPECT_EQ(Allocations() - before, 0) << part;
  }
}

TEST(NullSpaceControl, RefusesWhatDoesNotFit) {
  EXPECT_EQ(ErrorOfSetting({}), "no error");
  EXPECT_THAT(ErrorOfSetting({{"controller.tool", "end_effector"}}),
              HasSubstr("end_effector_link"));
  EXPECT_THAT(ErrorOfSetting({{"controller.tracking.gain", "0"}}), HasSubstr("tracking.gain"));
  EXPECT_THAT(ErrorOfSetting({{"controller.motion.radius", "0"}}), HasSubstr("radius"));
  EXPECT_THAT(ErrorOfSetting({{"controller.start_s", "0.005"}}),
              HasSubstr("start_s must be 0 or at least two periods of"));
  EXPECT_THAT(ErrorOfSetting({{"controller.fallback_damping", "-1"}}),
              HasSubstr("fallback_damping must be"));
  EXPECT_THAT(ErrorOfSetting({{"controller.null_space", "!LeastSquares {at: {link: elbow}}"}}),
              HasSubstr("elbow"));
  EXPECT_THAT(
      ErrorOfSetting({{"controller.motion",
                       "!Classical {position: [0.1, 0, 0], center: [0, 0, 0], normal: [1, 0, 0],"
                       " speed: 0.5}"}}),
      HasSubstr("normal must be perpendicular"));
}

}  // namespace
}  // namespace pliant
