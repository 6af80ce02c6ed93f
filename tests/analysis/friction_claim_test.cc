#include "pliant/analysis/friction_claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/friction_figure.h"
#include "pliant/analysis/friction_run.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using testing::HasSubstr;

const std::string kText = R"(title: t
summary: s
robot: gen3
station: !SimulatedArm {position: [0, 0, 0, 0, 0, 0, 0], engine: recursive}
controller: !FrictionExperiment {joints: [joint_1, joint_5]}
duration_s: 200
)";

Scenario ScenarioIn(const std::string& more = "") {
  return ExperimentFile::ReadText(kText + more, "e.yaml").scenarios.front();
}

/// A log in which joints 1 and 5 break away at s, twice each way, and go at four speeds both ways,
/// with c, d and the offset b of the sensor, and noise.
RunData Tested(double c, double d, double s, double b) {
  RunData run;
  run.name = run.title = "run";
  run.scenario = ScenarioIn();
  run.arm = StationOf(run.scenario);
  run.control = ControllerOf(run.scenario, run.arm);
  struct Row {
    int joint;
    FrictionPhase phase;
    bool steady;
    double v, torque;  // of the joint under test
  };
  std::vector<Row> rows;
  for (const int joint : {0, 4}) {
    const auto add = [&](FrictionPhase phase, double v, double torque, int count) {
      for (int k = 0; k < count; ++k) rows.push_back({joint, phase, v != 0, v, torque});
      for (int k = 0; k < 10; ++k) rows.push_back({joint, FrictionPhase::Return, false, 0, 0});
    };
    for (const double way : {1.0, -1.0, 1.0, -1.0}) add(FrictionPhase::BreakAway, 0, way * s, 100);
    for (const double way : {1.0, -1.0})
      for (const double v : {0.3, 0.6, 0.9, 1.2})
        add(FrictionPhase::Staircase, way * v, way * (c + d * v), 400);
  }
  const auto n = static_cast<Eigen::Index>(rows.size());
  const auto signal = [&](const std::string& path, std::vector<std::string> elements) {
    const std::vector<std::string> units(elements.size(), "");
    RecordedSignal made{{path, "", elements, units},
                        Eigen::VectorXd::LinSpaced(n, 0, 1e-3 * double(n - 1)),
                        Eigen::MatrixXd::Zero(std::ssize(elements), n)};
    return made;
  };
  std::vector<std::string> joints;
  for (int j = 1; j <= 7; ++j) joints.push_back("[joint_" + std::to_string(j) + "]");
  RecordedSignal q = signal("arm.measured_position", joints),
                 v = signal("arm.measured_velocity", joints),
                 i = signal("arm.measured_current", joints),
                 tau = signal("arm.measured_torque", joints),
                 report = signal("control.report",
                                 {".phase", ".joint", ".steady", ".stop", ".stopped_by"});
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.05);
  const PerJoint kappa = run.arm.actuators.torque_per_ampere();
  for (Eigen::Index k = 0; k < n; ++k) {
    const Row& row = rows[static_cast<std::size_t>(k)];
    v.numbers(row.joint, k) = row.v;
    i.numbers(row.joint, k) = row.torque / kappa(row.joint);
    tau.numbers(row.joint, k) = b + noise(random);
    report.numbers.col(k) << double(row.phase), double(row.joint), double(row.steady), 0, -1;
  }
  run.log = Recording({q, v, i, tau, report}, {});
  return run;
}

FrictionIdentified Of(FrictionTerm term, FrictionGroup group = FrictionGroup::Joints) {
  return {.claim = {.id = "id", .source = "source", .paper = "paper"},
          .run = "run",
          .term = term,
          .of = group};
}

/// With the same friction in both joints, which is also the truth.
RunData SameTruth(RunData run, double c, double d, double s) {
  for (const std::size_t j : {0u, 4u}) {
    FrictionParameters& friction = run.arm.actuators.joint[j].friction;
    friction.coulomb = c;
    friction.viscous = d;
    friction.stiction = s;
  }
  return run;
}

TEST(FrictionIdentified, HoldsWhereTheFrictionOfTheStationIsFound) {
  const RunData run = SameTruth(Tested(2, 1.5, 2.5, 0.4), 2, 1.5, 2.5);
  for (const auto group : {FrictionGroup::Joints, FrictionGroup::Sizes})
    for (const auto term : {FrictionTerm::Coulomb, FrictionTerm::Viscous, FrictionTerm::Static}) {
      const Claim claim = Of(term, group).Check(Runs({&run}));
      EXPECT_TRUE(claim.holds) << claim.measured;
      EXPECT_THAT(claim.measured, HasSubstr("joint_1 "));
      EXPECT_THAT(claim.measured, HasSubstr("joint_5 "));
    }
}

TEST(FrictionIdentified, FailsWhereItIsAnother) {
  const RunData run = Tested(2, 1.5, 2.5, 0.4);
  const auto holds = [&](double c, double d, double s, FrictionTerm term) {
    const RunData with = SameTruth(run, c, d, s);
    return Of(term).Check(Runs({&with})).holds;
  };
  // σ_d = 0.05 N·m drifts by less than 0.05 N·m in 7 s.
  EXPECT_FALSE(holds(2.1, 1.5, 2.5, FrictionTerm::Coulomb));
  EXPECT_FALSE(holds(2, 1.6, 2.5, FrictionTerm::Viscous));
  EXPECT_FALSE(holds(2, 1.5, 2.6, FrictionTerm::Static));
}

TEST(FrictionIdentified, FailsWhereAJointWasNotTested) {
  RunData run = SameTruth(Tested(2, 1.5, 2.5, 0.4), 2, 1.5, 2.5);
  std::get<FrictionExperiment::Options>(run.control).test.joints.push_back("joint_7");
  const Claim claim = Of(FrictionTerm::Coulomb).Check(Runs({&run}));
  EXPECT_FALSE(claim.holds);
  EXPECT_THAT(claim.measured, HasSubstr("joint_7 was not tested"));
}

TEST(FrictionRun, HandsOnTheJointsThatWereTestedAndNoOthers) {
  const RunData run = Tested(2, 1.5, 2.5, 0.4);
  const std::vector<TestedDrive> drives = TestedDrivesOf(run);
  ASSERT_EQ(drives.size(), 2u);
  EXPECT_EQ(drives[1].log.joint, "joint_5");
  EXPECT_EQ(drives[1].drive.torque_per_ampere, run.arm.actuators.joint[4].torque_per_ampere());
  EXPECT_EQ(drives[1].drive.reflected_inertia, run.arm.actuators.joint[4].reflected_inertia());
  EXPECT_EQ(drives[1].log.samples.velocity, TestedJointsOf(run)[1].samples.velocity);
  EXPECT_FALSE(FrictionRunOf("none.mcap"));
  EXPECT_FALSE(FrictionRunOf("sweep.csv"));
}

TEST(FrictionRun, TakesTheRotorsOffTheTorque) {
  RunData run = Tested(2, 0, 2, 0);
  std::vector<RecordedSignal> signals = run.log.signals();
  const Eigen::VectorXd t = signals.front().times;
  // Everything turns ever faster by 0.2 rad/s², and the current makes up for it.
  const PerJoint B = run.arm.actuators.reflected_inertia(),
                 kappa = run.arm.actuators.torque_per_ampere();
  for (int j = 0; j < 7; ++j) {
    signals[1].numbers.row(j) += 0.2 * t.transpose();
    signals[2].numbers.row(j).array() += 0.2 * B(j) / kappa(j);
  }
  run.log = Recording(signals, {});
  const std::vector<TestedJoint> joints = TestedJointsOf(run);
  ASSERT_EQ(joints.size(), 2u);
  for (const TestedJoint& joint : joints) {
    EXPECT_EQ(joint.samples.begin.size(), 8u);
    EXPECT_EQ(joint.samples.break_away.size(), 4);
    // The sensor's noise of 0.05 N·m, of 400 samples: 5 standard deviations.
    EXPECT_NEAR(joint.samples.torque.head(400).mean(), 2, 5 * 0.05 / 20);
  }
}

TEST(FrictionFigure, HasAPanelForEachActuatorSize) {
  const RunData run = Tested(2, 1.5, 2.5, 0.4);
  const Figure figure = FrictionFigure{.name = "f", .run = "run"}.Draw(Runs({&run}));
  ASSERT_EQ(figure.panels.size(), 2u);
  EXPECT_THAT(figure.panels[0].title, HasSubstr("c = 2"));
  ASSERT_EQ(figure.panels[0].curves.size(), 2u) << "one joint and the fit";
  EXPECT_EQ(figure.panels[0].curves[0].label, "joint_1");
  ASSERT_EQ(figure.panels[0].y_bands.size(), 1u);
  EXPECT_NEAR(figure.panels[0].y_bands[0].to, 2.5, 0.05);
}

TEST(FrictionFigure, DrawsNothingThatWasNotIdentified) {
  RunData run = Tested(2, 1.5, 2.5, 0.4);
  std::vector<RecordedSignal> signals = run.log.signals();
  // One speed does not tell c from d.
  signals[1].numbers = 0.6 * signals[1].numbers.cwiseSign();
  run.log = Recording(signals, {});
  const Figure figure = FrictionFigure{.name = "f", .run = "run"}.Draw(Runs({&run}));
  ASSERT_EQ(figure.panels.size(), 2u);
  EXPECT_THAT(figure.panels[0].title, HasSubstr("c = – N·m, d = – N·m·s/rad, s = 2.5"));
  EXPECT_EQ(figure.panels[0].curves.size(), 1u) << "the joint without a fit";
  EXPECT_EQ(figure.panels[0].y_bands.size(), 1u);
}

TEST(FrictionIdentified, IsAboutAFrictionExperimentAndComplianceClaimsAreNot) {
  const auto error = [](const std::string& claim, const std::string& text = kText) {
    return ErrorOf(
        [&] { ExperimentFile::ReadText(text + "claims:\n  - " + claim + "\n", "e.yaml"); });
  };
  const std::string head = "id: a, source: b, paper: c";
  EXPECT_EQ(error("!FrictionIdentified {" + head + ", run: run}"), "no error");
  for (const std::string& tag :
       {"!KeepsLimits {" + head + "}", "!StandsStill {" + head + ", run: run}",
        "!KeepsDamper {" + head + ", runs: [run], joint: joint_1}"})
    EXPECT_EQ(error(tag),
              "e.yaml: claim 'a': it is about a controller of the kind !Compliance, got "
              "!FrictionExperiment");
  std::string compliant = kText;
  compliant.replace(compliant.find("!FrictionExperiment"), std::string::npos,
                    "!Compliance {tool: tool_frame}\nduration_s: 1\n");
  EXPECT_EQ(error("!FrictionIdentified {" + head + ", run: run}", compliant),
            "e.yaml: claim 'a': it is about a controller of the kind !FrictionExperiment");
}

TEST(ExperimentFile, ReadsFrictionFromAFileBesideIt) {
  const TemporaryDirectory folder;
  std::ofstream(folder.path() / "friction.yaml")
      << FrictionFile{.sources = {"a.mcap"},
                      .model = "stribeck",
                      .loss = "cauchy",
                      .directions = "together",
                      .joints = {{.joint = "joint_2", .coulomb = 4, .viscous = 2}}}
             .text();
  std::string text = kText;
  text.replace(text.find("engine"), 6, "friction: friction.yaml, engine");
  std::ofstream(folder.path() / "e.yaml") << text << "assumed_friction: friction.yaml\n";
  const ExperimentFile file = ExperimentFile::Read(folder.path() / "e.yaml");
  EXPECT_EQ(StationOf(file.scenarios.front()).actuators.joint[1].friction.coulomb, 4);
  ASSERT_EQ(file.scenarios.front().assumed_friction.size(), 1u);
  EXPECT_EQ(file.scenarios.front().assumed_friction[0].viscous, 2);
  std::ofstream(folder.path() / "friction.yaml") << "joint: 3\n";
  EXPECT_THAT(ErrorOf([&] { ExperimentFile::Read(folder.path() / "e.yaml"); }),
              HasSubstr("friction.yaml:1:1: "));
  std::filesystem::remove(folder.path() / "friction.yaml");
  EXPECT_THAT(ErrorOf([&] { ExperimentFile::Read(folder.path() / "e.yaml"); }),
              HasSubstr("friction.yaml"));
}

}  // namespace
}  // namespace pliant
