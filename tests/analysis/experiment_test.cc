#include "pliant/analysis/experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pliant/plants/parameter_text.h"
#include "pliant/tests/analysis/compliance_experiment.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

ExperimentFile Read(const std::string& more, const Overrides& set = {}) {
  return ExperimentFile::ReadText(kShort + more, "e.yaml", set);
}

std::string ErrorWith(const std::string& more, const Overrides& set = {}) {
  return ErrorOf([&] { Read(more, set); });
}

std::string Claimed(const std::string& check) { return "claims:\n  - " + check + "\n"; }

const std::string kStated = "id: a, source: s, paper: p";

TEST(ExperimentFile, HasAScenarioForEachRun) {
  const ExperimentFile file = Read("", {{"controller.observer_gain", "20"}});
  ASSERT_EQ(file.scenarios.size(), 2u);
  const auto control = [&](std::size_t run) {
    return std::get<ComplianceControl::Options>(file.scenarios[run].controller);
  };
  EXPECT_EQ(control(0).pose.compliance.size(), 0);
  EXPECT_EQ(control(1).pose.compliance, TaskMatrix::Constant(1, 1, 1));
  EXPECT_EQ(control(1).posture.compliance, JointMatrix::Constant(1, 1, 1));
  for (const std::size_t run : {0, 1}) EXPECT_EQ(control(run).observer_gain, 20);
}

TEST(ExperimentFile, HasOneRunIfNoneIsGiven) {
  const ExperimentFile file = Read("", {{"runs", "~"}});
  ASSERT_EQ(file.scenarios.size(), 1u);
  EXPECT_EQ(file.experiment.runs[0].name, "run");
  EXPECT_EQ(file.experiment.runs[0].title, "Short");
}

TEST(ExperimentFile, ReadsItsEffectiveTextBackToTheSame) {
  for (const NamedExperiment& named : Experiments()) {
    const ExperimentFile file = ExperimentFile::Read(
        named.file, {{"station.engine", "recursive"}, {"integrator.relative_tolerance", "1e-7"}});
    const ExperimentFile back = ExperimentFile::ReadText(file.text(), "effective");
    EXPECT_EQ(back.text(), file.text());
    ASSERT_EQ(back.scenarios.size(), file.scenarios.size());
    for (std::size_t i = 0; i < file.scenarios.size(); ++i)
      EXPECT_EQ(ParametersText(back.scenarios[i]), ParametersText(file.scenarios[i]));
  }
}

TEST(ExperimentFile, RefusesNamesOfRunsThatCannotNameLogs) {
  for (const char* name : {"a b", "../a", "a.b", "é", "a/b"})
    EXPECT_EQ(ErrorWith("", {{"runs.0.name", name}}),
              "e.yaml: the name of a run, which names its log, has letters, digits, '_' and '-', "
              "got '" +
                  std::string(name) + "'");
  EXPECT_EQ(ErrorWith("", {{"runs.0.name", "full"}}), "e.yaml: two runs are named 'full'");
}

TEST(ExperimentFile, RefusesChangesThatARunCannotMake) {
  EXPECT_EQ(ErrorWith("", {{"runs.1.set", "{claims: []}"}}),
            "e.yaml: run 'full': a run changes its scenario only, not 'claims'");
  EXPECT_EQ(ErrorWith("", {{"runs.1.set", "{title: x}"}}),
            "e.yaml: run 'full': a run changes its scenario only, not 'title'");
  EXPECT_THAT(ErrorWith("", {{"runs.1.set", "{controler.observer_gain: 1}"}}),
              StartsWith("e.yaml: run 'full', controler.observer_gain: 1: there is no 'controler' "
                         "here; did you mean 'controller'?"));
  EXPECT_EQ(ErrorWith("", {{"runs.1.set", "{duration_s: -1}"}}),
            "e.yaml: run 'full', duration_s: -1: duration_s must be from 0.001 to 1000000 s, got "
            "-1");
  EXPECT_THAT(ErrorWith("", {{"runs.1.set", "{controller.tool: hand}"}}),
              AllOf(StartsWith("e.yaml: run 'full': "), HasSubstr("has no link \"hand\"")));
}

TEST(ExperimentFile, RefusesOverridesByTheirName) {
  EXPECT_EQ(ErrorWith("", {{"duration_s", "-1"}}),
            "--set duration_s=-1: duration_s must be from 0.001 to 1000000 s, got -1");
}

TEST(ExperimentFile, RefusesClaimsAboutWhatIsNotThere) {
  EXPECT_EQ(ErrorWith(Claimed("!StandsStill {" + kStated + ", run: stif}")),
            "e.yaml: claim 'a': there is no run 'stif'; did you mean 'stiff'?");
  const auto bound = [](const std::string& more) {
    return ErrorWith(
        Claimed("!Bound {" + kStated + ", basis: b, run: full, most: 1, signal: " + more + "}"));
  };
  EXPECT_EQ(bound("control.pose_error"),
            "e.yaml: claim 'a': the elements of control.pose_error are in [rad] and in [m]; name "
            "elements of one unit");
  EXPECT_EQ(bound("control.pose_error, elements: [x, y, z]"), "no error");
  EXPECT_EQ(bound("push_1.force, elements: ['force[x]']"), "no error");
  EXPECT_EQ(
      bound("push_1.force"),
      "e.yaml: claim 'a': the elements of push_1.force are in [] and in [m]; name elements of "
      "one unit");
  EXPECT_THAT(bound("control.pose_eror"), AllOf(StartsWith("e.yaml: claim 'a': "),
                                                HasSubstr("did you mean 'control.pose_error'?")));
  EXPECT_THAT(
      bound("arm.velocity, elements: [joint_8]"),
      AllOf(StartsWith("e.yaml: claim 'a': "), HasSubstr("joint_8"), HasSubstr("did you mean")));
  EXPECT_EQ(bound("arm.velocity, from_s: 0.2"),
            "e.yaml: claim 'a': from_s must be <= duration_s, 0.1, got 0.2");
  EXPECT_EQ(ErrorWith(Claimed("!Bound {" + kStated + ", basis: b, run: full, signal: arm.energy}")),
            "e.yaml: claim 'a': least or most must be given");
  EXPECT_EQ(
      ErrorWith(Claimed("!YieldsAsInertia {" + kStated + ", run: full}"), {{"duration_s", "0.05"}}),
      "e.yaml: claim 'a': duration_s must be >= 0.06, when its last push has lasted, got "
      "0.05");
  EXPECT_EQ(
      ErrorWith(Claimed("!YieldsAsInertia {" + kStated + ", run: full}"), {{"environment", "[]"}}),
      "e.yaml: claim 'a': there is no !Push in the environment of its run");
}

TEST(ExperimentFile, RefusesClaimsAboutTheControllersErrorWherePositionsAreCommanded) {
  for (const char* claim : {"!StandsStill", "!HoldsTool"})
    EXPECT_EQ(ErrorWith(Claimed(std::string(claim) + " {" + kStated + ", run: full}"),
                        {{"controller.command", "position"}}),
              "e.yaml: claim 'a': controller.command must be torque: with positions, "
              "control.pose_error is not the arm's");
}

TEST(ExperimentFile, RefusesLogsThatAreTooCoarseForItsClaims) {
  const auto coarse = [](const std::string& claim) {
    return ErrorWith(Claimed(claim), {{"log_period", "10 ms"}});
  };
  const std::string too_coarse =
      "e.yaml: claim 'a': log_period must be <= 1 ms, the controller's period, got 10 ms";
  for (const char* claim : {"!StandsStill", "!HoldsTool", "!YieldsAsInertia"})
    EXPECT_EQ(coarse(std::string(claim) + " {" + kStated + ", run: full}"), too_coarse);
  EXPECT_EQ(coarse("!KeepsLimits {" + kStated + "}"), too_coarse);
}

TEST(ExperimentFile, RefusesToSetWhatARunSets) {
  EXPECT_EQ(ErrorWith("", {{"controller.pose.compliance", "0.5"}}),
            "--set controller.pose.compliance=0.5: run 'full' sets it too, and would have its way");
}

TEST(ExperimentFile, RefusesRunsOfDifferentRobots) {
  EXPECT_EQ(ErrorWith("", {{"runs.0.set", "{robot: gen3_bota}"}}),
            "e.yaml: run 'stiff': all runs of an experiment have one robot");
}

TEST(ExperimentFile, SaysThatAControllerIsMissing) {
  std::string text = kShort;
  const std::string controller = "controller: !Compliance {tool: tool_frame}\n";
  text.erase(text.find(controller), controller.size());
  EXPECT_EQ(ErrorOf([&] { ExperimentFile::ReadText(text, "e.yaml"); }),
            "e.yaml:1:1: 'controller' is missing");
}

// What one run has and another has not.
TEST(ExperimentFile, LooksForSignalsInTheRunThatIsNamed) {
  const auto of = [](const std::string& run) {
    return ErrorWith(
        Claimed("!Bound {" + kStated +
                ", basis: b, most: 1, signal: push_1.force, elements: ['force[x]'], run: " + run +
                "}"),
        {{"runs.1.set", "{environment: []}"}});
  };
  EXPECT_EQ(of("stiff"), "no error");
  EXPECT_THAT(of("full"), HasSubstr("push_1.force"));
}

TEST(ExperimentFile, RefusesTwoClaimsOfOneId) {
  EXPECT_EQ(
      ErrorWith(Claimed("!KeepsLimits {" + kStated + "}") + "  - !KeepsLimits {" + kStated + "}\n"),
      "e.yaml: claim 'a': there are two of that id");
}

TEST(ExperimentFile, RefusesFiguresThatCannotBeDrawn) {
  const auto figures = [](const std::string& list) {
    return ErrorWith("figures: [" + list + "]\n");
  };
  EXPECT_EQ(figures("!Limits {run: ful}"),
            "e.yaml: figure !Limits: there is no run 'ful'; did you mean 'full'?");
  EXPECT_EQ(figures("!Velocities {runs: [stiff, ful]}"),
            "e.yaml: figure !Velocities: there is no run 'ful'; did you mean 'full'?");
  EXPECT_EQ(figures("!Velocities {runs: []}"), "e.yaml: figure !Velocities: it is about no run");
  EXPECT_EQ(figures("!Predictions {as_if_static: [ful]}"),
            "e.yaml: figure !Predictions: there is no run 'ful'; did you mean 'full'?");
  const auto signals = [&](const std::string& name, const std::string& list) {
    return figures("!Signals {name: " + name + ", caption: c, runs: [full], signals: " + list +
                   "}");
  };
  EXPECT_EQ(signals("n", "[arm.energy]"), "no error");
  EXPECT_EQ(signals("n", "[]"), "e.yaml: figure !Signals: it shows no signal");
  EXPECT_THAT(signals("n", "[arm.enery]"), HasSubstr("did you mean 'arm.energy'?"));
  EXPECT_EQ(figures("!Norms {name: n, caption: c, runs: [full], signals: [control.contact]}"),
            "e.yaml: figure !Norms: the elements of control.contact are in [N·m] and in [N]; name "
            "elements of one unit");
  EXPECT_EQ(signals("a b", "[arm.energy]"),
            "e.yaml: figure !Signals: its name, which names its file, has letters, digits, '_' "
            "and '-', got 'a b'");
  EXPECT_EQ(figures("!Limits {run: full}, !Limits {run: stiff}"),
            "e.yaml: figure !Limits: there are two figures named 'limits'");
  EXPECT_EQ(figures("!Limits {run: full}, !Limits {name: other, run: stiff}"), "no error");
  for (const char* tag :
       {"Velocities {runs: [full]", "Limits {run: full", "Predictions {as_if_static: [full]"})
    EXPECT_THAT(figures("!" + std::string(tag) + ", name: a b}"),
                HasSubstr("its name, which names its file, has letters, digits, '_' and '-'"));
  EXPECT_THAT(figures("!Phase {name: n, caption: c, runs: [full], joint: joint_8}"),
              AllOf(StartsWith("e.yaml: figure !Phase: "),
                    HasSubstr("has no element 'joint_8'; did you mean")));
  EXPECT_EQ(figures("!Phase {name: n, caption: c, runs: [full], joint: joint_1, from_s: 1}"),
            "e.yaml: figure !Phase: from_s must be <= duration_s, 0.1, got 1");
  EXPECT_EQ(figures("!Path {name: n, caption: c, runs: [full]}"),
            "e.yaml: figure !Path: it shows no plane");
  EXPECT_THAT(figures("!Path {name: n, caption: c, runs: [full], planes: [{x: {signal: "
                      "control.pose_error, element: q}, y: {signal: arm.energy, element: ''}}]}"),
              HasSubstr("'element' says nothing"));
  EXPECT_THAT(figures("!Path {name: n, caption: c, runs: [full], planes: [{x: {signal: "
                      "control.pose_error, element: xx}, y: {signal: control.pose_error, element: "
                      "y}}]}"),
              AllOf(StartsWith("e.yaml: figure !Path: "), HasSubstr("xx")));
  EXPECT_EQ(figures("!Bars {name: n, caption: c, runs: [full]}"),
            "e.yaml: figure !Bars: it shows no number");
  EXPECT_THAT(figures("!Bars {name: n, caption: c, runs: [full], numbers: [{title: t, signal: "
                      "control.pose_error}]}"),
              StartsWith("e.yaml: figure !Bars: the elements of control.pose_error are in [rad]"));
}

TEST(ExperimentFile, RefusesClaimsThatSoFewRepetitionsCannotSupport) {
  const std::string number = ", signal: control.pose_error, elements: [x, y, z]}";
  const auto differs = [&](const Overrides& set) {
    return ErrorWith(Claimed("!Differs {" + kStated + ", run: stiff, than: full" + number), set);
  };
  EXPECT_EQ(differs({}),
            "e.yaml: claim 'a': p of 1 repetition is never below 1, and alpha is 0.05; give "
            "--repeat 4 or more");
  EXPECT_EQ(differs({{"repeat", "4"}}), "no error");
  EXPECT_EQ(ErrorWith(Claimed("!Equivalent {" + kStated +
                              ", basis: b, margin: 1, run: stiff, to: full" + number)),
            "e.yaml: claim 'a': one repetition says nothing of how numbers scatter; give --repeat "
            "2 or more");
  EXPECT_EQ(differs({{"repeat", "0"}}), "--set repeat=0: repeat must be from 1 to 100000, got 0");
}

TEST(ExperimentFile, RefusesClaimsOverRunsThatAreNotThere) {
  const std::string number = ", signal: control.pose_error, elements: [x, y, z]}";
  const std::string no_run = "e.yaml: claim 'a': there is no run 'ful'; did you mean 'full'?";
  const Overrides often{{"repeat", "5"}};
  EXPECT_EQ(ErrorWith(Claimed("!Differs {" + kStated + ", run: stiff, than: ful" + number), often),
            no_run);
  EXPECT_EQ(ErrorWith(Claimed("!Equivalent {" + kStated +
                              ", basis: b, margin: 1, run: stiff, to: ful" + number),
                      often),
            no_run);
  EXPECT_EQ(ErrorWith(Claimed("!Order {" + kStated + ", basis: b, runs: [stiff, ful]" + number)),
            no_run);
  EXPECT_THAT(ErrorWith(Claimed("!Order {" + kStated +
                                ", basis: b, runs: [stiff, full], signal: control.pose_eror}")),
              HasSubstr("did you mean 'control.pose_error'?"));
}

TEST(ExperimentFile, SaysHowOftenItIsRepeated) {
  EXPECT_EQ(Read("").experiment.repeat, 1);
  EXPECT_EQ(Read("repeat: 30\n").experiment.repeat, 30);
  EXPECT_EQ(Read("repeat: 30\n", {{"repeat", "2"}}).experiment.repeat, 2);
  EXPECT_EQ(ErrorWith("", {{"runs.1.set", "{repeat: 3}"}}),
            "e.yaml: run 'full': a run changes its scenario only, not 'repeat'");
}

}  // namespace
}  // namespace pliant
