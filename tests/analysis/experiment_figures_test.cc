#include "pliant/analysis/experiment_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/tests/analysis/compliance_experiment.h"
#include "pliant/tests/analysis/repetitions.h"

namespace pliant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RunsReport Drawn(const std::string& more, const Overrides& set = {}) {
  const TemporaryDirectory out;
  return ReportOf(
      RunExperiment(ExperimentFile::ReadText(kShort + more, "e.yaml", set), {.out = out.path()}));
}

// A push of 20 N for 0.08 s, a mass of 0.5 kg that the rope carries from the start, a hand from
// 0.05 s on.
TEST(VelocityFigure, AddsTheForcesOfAllContactsAndShadesHolds) {
  const RunsReport of = Drawn(
      "figures: [!Velocities {name: v, runs: [full]}]\n",
      {{"environment",
        "[!Push {link: tool_frame, force: [0, 0, -20], start_s: 0, duration_s: 0.08, edge_s: "
        "0.02}, !MassOnRope {link: tool_frame, mass: 0.5, length: 0.2, stiffness: 2000, damping: "
        "5, position: [0.4567, 0.0014, 0.2313]}, !Hand {link: forearm_link, stiffness: [500, 500, "
        "500], damping: 20, start_s: 0.05, duration_s: 0.03}]"}});
  const Panel& panel = of.report.figures.at(0).panels.at(0);
  EXPECT_EQ(of.report.figures[0].name, "v");
  ASSERT_EQ(panel.x_bands.size(), 2u);
  EXPECT_DOUBLE_EQ(panel.x_bands[1].from, 0.05);
  EXPECT_DOUBLE_EQ(panel.x_bands[1].to, 0.08);
  const Recording& log = of.runs()["full"].log;
  const std::vector<double>& force = panel.curves.at(1).y;
  double largest_of_hand = 0;
  for (std::size_t k = 0; k < force.size(); ++k) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const char* path : {"push_1.force", "mass_1.contact", "hand_1.contact"}) {
      const auto of_axis = [&](const char* axis) { return log[path][axis](static_cast<int>(k)); };
      const Eigen::Vector3d one{of_axis("force[x]"), of_axis("force[y]"), of_axis("force[z]")};
      sum += one;
      if (path[0] == 'h') largest_of_hand = std::max(largest_of_hand, one.norm());
    }
    EXPECT_NEAR(force[k], sum.norm(), 1e-12);  // round-off of some 20 N
  }
  EXPECT_GT(largest_of_hand, 0);
}

TEST(NormFigure, DrawsACurveForEachRun) {
  const RunsReport of = Drawn(
      "figures: [!Norms {name: n, caption: c, runs: [stiff, full], signals: [control.torque, "
      "arm.velocity], logarithmic: true}]\n");
  const Figure& figure = of.report.figures.at(0);
  ASSERT_EQ(figure.panels.size(), 2u);
  const Panel& panel = figure.panels[0];
  EXPECT_EQ(panel.left.label, "‖control.torque‖ [N·m]");
  EXPECT_TRUE(panel.left.logarithmic);
  ASSERT_EQ(panel.curves.size(), 2u);
  EXPECT_EQ(panel.curves[1].label, of.runs()["full"].title);
  const Eigen::MatrixXd& torque = of.runs()["full"]["control.torque"];
  for (const std::size_t k : {std::size_t{0}, panel.curves[1].y.size() - 1})
    EXPECT_DOUBLE_EQ(panel.curves[1].y[k], torque.col(static_cast<Eigen::Index>(k)).norm());
}

// λ/(4M²) (q⁺ − d_s − q), with other M in the two runs; the arm stands near no other limit.
TEST(PhaseFigure, DrawsTheBoundsAndWhereEachDamperBegins) {
  const RunsReport of =
      Drawn("figures: [!Phase {name: p, caption: c, runs: [stiff, full], joint: joint_4}]\n",
            {{"station.position", "[0, 0.26, 3.14, -2.5, 0, 0.96, 1.57]"},
             {"environment.0.force", "[0, 0, -200]"},
             {"runs.0.set", "{controller.damper.damping_ratio: 3}"},
             {"runs.1.set",
              "{controller.pose.compliance: 1, controller.posture.compliance: 1, "
              "controller.pose.stiffness: 0, controller.damper.velocity_fraction: "
              "0.5}"}});
  const RunData& run = of.runs()["full"];
  const Joint& joint = run.arm.model.joint(3);
  const double safe = joint.lower + 0.01 * (joint.upper - joint.lower);
  const Panel& panel = of.report.figures.at(0).panels.at(0);
  ASSERT_EQ(panel.x_limits.size(), 2u);
  EXPECT_DOUBLE_EQ(panel.x_limits[0].at, safe);
  EXPECT_DOUBLE_EQ(panel.x_limits[1].at, joint.lower);
  ASSERT_EQ(panel.x_bands.size(), 2u);
  EXPECT_TRUE(panel.x_bands[0].forbidden);
  EXPECT_DOUBLE_EQ(panel.x_bands[0].to, safe);
  std::vector<double> slopes;
  for (const Curve& curve : panel.curves)
    if (curve.draw == Curve::Draw::Dashes) {
      EXPECT_DOUBLE_EQ(curve.x[1], safe);
      EXPECT_DOUBLE_EQ(curve.y[1], 0);
      slopes.push_back((curve.y[1] - curve.y[0]) / (curve.x[1] - curve.x[0]));
    }
  EXPECT_THAT(slopes, ElementsAre(testing::DoubleEq(-100.0 / 36), testing::DoubleEq(-100.0 / 16)));
  for (const LimitLine& limit : panel.limits)
    EXPECT_DOUBLE_EQ(std::abs(limit.at), joint.velocity);  // of the run that is allowed most
  EXPECT_EQ(panel.curves[0].label, "stiff");
  EXPECT_LT(*panel.x.from, joint.lower);
}

TEST(PhaseFigure, DrawsNoBoundThatIsFarOffAndNoneOfAContinuousJoint) {
  const RunsReport of = Drawn(
      "figures: [!Phase {name: p, caption: c, runs: [full], joint: joint_1}, !Phase {name: q, "
      "caption: c, runs: [full], joint: joint_4, from_s: 0.05, to_s: 0.06}]\n");
  for (const Figure& figure : of.report.figures) {
    EXPECT_TRUE(figure.panels.at(0).x_limits.empty());
    EXPECT_TRUE(figure.panels[0].x_bands.empty());
  }
  EXPECT_EQ(of.report.figures[1].panels[0].curves.at(0).x.size(), 11u);
}

TEST(PathFigure, PutsTwoNumbersAgainstEachOtherInOneScale) {
  const RunsReport of = Drawn(
      "figures: [!Path {name: p, caption: c, runs: [stiff, full], planes: [{x: {signal: "
      "control.pose_error, element: x}, y: {signal: control.pose_error, element: z}}, {x: {signal: "
      "arm.position, element: joint_1}, y: {signal: arm.velocity, element: joint_1}}]}]\n");
  const Figure& figure = of.report.figures.at(0);
  EXPECT_EQ(figure.columns, 2);
  const Panel& path = figure.panels.at(0);
  EXPECT_TRUE(path.equal_scales);
  EXPECT_FALSE(figure.panels.at(1).equal_scales);  // rad and rad/s
  const Eigen::VectorXd x = of.runs()["full"].log["control.pose_error"]["x"],
                        z = of.runs()["full"].log["control.pose_error"]["z"];
  // Both in the unit of the larger.
  EXPECT_EQ(path.x.label, "control.pose_error[x] [mm]");
  EXPECT_EQ(path.left.label, "control.pose_error[z] [mm]");
  EXPECT_EQ(path.curves.at(1).label, "full");
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    EXPECT_DOUBLE_EQ(path.curves[1].x[static_cast<std::size_t>(k)], x(k) / 1e-3);
    EXPECT_DOUBLE_EQ(path.curves[1].y[static_cast<std::size_t>(k)], z(k) / 1e-3);
  }
}

BarFigure Bars(const std::vector<std::string>& runs) {
  BarFigure bars{.name = "bars", .caption = "c", .runs = runs};
  bars.numbers = {{.title = "height", .number = {.signal = "a.b"}}};
  return bars;
}

// Of 4 against 4 apart p = 2/70, of 8 against 8 it is 2/12870; SD of 1, 2, 3, 4 is √(5/3).
TEST(BarFigure, ShowsMeanAndDeviationAndWhatATestSaysOfThem) {
  const BarFigure figure = Bars({"a", "b"});
  const auto drawn = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return figure.Draw({Measured(figure, {{"a", a}, {"b", b}})}).panels.at(0);
  };
  const Panel panel = drawn({0.001, 0.002, 0.003, 0.004}, {0.01, 0.02, 0.03, 0.04});
  EXPECT_EQ(panel.title, "height [mm]");
  EXPECT_EQ(panel.bars.at(0).label, "run a");
  EXPECT_NEAR(panel.bars[0].mean, 2.5, 1e-12);
  EXPECT_NEAR(panel.bars[0].deviation, std::sqrt(5.0 / 3), 1e-12);
  ASSERT_EQ(panel.brackets.size(), 1u);
  EXPECT_EQ(panel.brackets[0].label, "*");
  EXPECT_EQ(drawn({1, 2, 3, 4}, {1.5, 2.5, 3.5, 4.5}).brackets.at(0).label, "n.s.");
  const std::vector<double> low{1, 2, 3, 4, 5, 6, 7, 8}, high{11, 12, 13, 14, 15, 16, 17, 18};
  EXPECT_EQ(drawn(low, high).brackets.at(0).label, "**");
  EXPECT_TRUE(drawn({1}, {2}).brackets.empty());
  EXPECT_TRUE(drawn({1, kUnbounded}, {2, 3}).brackets.empty());
}

TEST(BarFigure, TellsRunsOfOneTitleApart) {
  const BarFigure figure = Bars({"a", "b"});
  RepeatedNumber number = figure.Wanted().front();
  RunData a = RunWith("a", 1), b = RunWith("b", 2);
  a.title = b.title = "same";
  number.Add(Runs({&a, &b}));
  const Panel panel = figure.Draw({number}).panels.at(0);
  EXPECT_EQ(panel.bars.at(0).label, "same (a)");
  EXPECT_EQ(panel.bars.at(1).label, "same (b)");
}

TEST(BarFigure, DrawsWhatNeverSettledAsNoBar) {
  const BarFigure figure = Bars({"a", "b"});
  const Figure drawn = figure.Draw({Measured(figure, {{"a", {kUnbounded, 1}}, {"b", {1, 2}}})});
  EXPECT_TRUE(std::isnan(drawn.panels.at(0).bars.at(0).mean));
  const TemporaryDirectory out;
  EXPECT_THAT(DrawFigure(drawn, out.path()), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace pliant
