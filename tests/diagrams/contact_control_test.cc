#include "pliant/diagrams/contact_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"

namespace pliant {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const std::string kText = R"(robot: lwr
station: !SimulatedArm {engine: recursive}
controller: !ContactControl
  tool: end_effector_link
  threshold: [3, 3, 1.2, 1.2, 0.6, 0.6, 0.6]
integrator: {method: dormand_prince}
duration_s: 6
)";

const Overrides kIdeal{{"station.ideal", "true"}};

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

/// Runs a scenario and shows each tick of its controller.
struct Course {
  explicit Course(const Overrides& set)
      : scenario{ScenarioIn(set)},
        scene{scenario},
        diagram{scene.builder.Build()},
        sim{diagram, {.integrator = scenario.integrator}} {}

  void To(
      double time, const std::function<void(double)>& see = [](double) {}) {
    const double h = seconds(scene.control_period);
    while (ticks * h < time) {
      sim.AdvanceTo(++ticks * h + 1e-6);
      see(ticks * h);
    }
  }
  const ContactControl& control() const { return *scene.contact; }
  const ContactTasks& tasks() const { return *scene.contact->contact_tasks; }
  const ContactPlace& place(std::size_t i) const { return *tasks().places[i]; }
  template <class V>
  const typename V::Signal& Get(const V& value) {
    return sim.Get(value);
  }

  Scenario scenario;
  ScenarioDiagram scene;
  Diagram diagram;
  Simulator sim;
  int ticks = 0;
};

std::string Push(const std::string& link, const std::string& force, double start, double duration) {
  return "!Push {link: " + link + ", force: " + force + ", start_s: " + std::to_string(start) +
         ", duration_s: " + std::to_string(duration) + ", edge_s: 0.02}";
}

Overrides With(Overrides set, const Overrides& more) {
  set.insert(set.end(), more.begin(), more.end());
  return set;
}

TEST(ContactControl, HoldsThePostureAndFeelsNothingUntilItIsTouched) {
  for (const Overrides& robot : {Overrides{}, Overrides{{"robot", "gen3"},
                                                        {"controller.tool", "tool_frame"},
                                                        {"controller.threshold", "3"}}}) {
    Course run(With(robot, {{"duration_s", "5"}}));
    const JointPosition start = run.Get(run.scene.arm->position);
    run.To(5, [&](double) {
      EXPECT_FALSE(run.Get(run.tasks().touched));
      EXPECT_EQ(run.Get(run.control().report).outcome, ContactLawReport::Outcome::Posture);
    });
    // The friction that holds a joint off, at most some N·m, over λ₂ M of at least 10 N·m/rad.
    EXPECT_LT((run.Get(run.scene.arm->position) - start).cwiseAbs().maxCoeff(), 0.1);
  }
}

TEST(ContactControl, FindsTheForceAndBringsThePointBack) {
  Course run({{"environment", "[" + Push("link_6", "[0, 20 N, 0]", 2, 2) + "]"}});
  run.To(3.9);
  EXPECT_TRUE(run.Get(run.tasks().touched));
  EXPECT_EQ(run.Get(run.tasks().contacts).count(), 1);
  // 5 standard deviations of the residual, 0.7 N·m, over a lever arm of half a metre.
  EXPECT_LT(run.Get(run.place(0).force_error).norm(), 7);
  // F/K_p; 0.9 N of Coulomb friction along y are 1.8 mm, and 1 mm is noise.
  EXPECT_NEAR(run.Get(run.place(0).error)(1), -20.0 / 500, 2.8e-3);
  run.To(6);
  EXPECT_FALSE(run.Get(run.tasks().touched));
  // Coulomb friction of all joints holds off 3.5 N at most, over K_p.
  EXPECT_LT(run.Get(run.place(0).error).norm(), 3.5 / 500);
  EXPECT_EQ(run.Get(run.control().report).rows, 3) << "the point is kept";
}

/// ω_n and ζ of the free motion along an axis after a push, by least squares of its integral:
/// ẋ = c₀ − 2ζω x − ω² ∫(x − x_∞), x_∞ = 0. While it is pushed, F − F̂ moves it as well.
struct Fit {
  double omega, zeta;
};
Fit Identify(int axis, const std::string& force) {
  const double released = 3.5;
  Course run(With(kIdeal, {{"controller.behavior",
                            "!Impedance {inertia: [20, 3, 10], damping: 80, stiffness: 500}"},
                           {"environment", "[" + Push("link_6", force, 2, 1.5) + "]"}}));
  std::vector<Vector3d> rows;  // x, ∫x, ẋ
  double sum = 0;
  run.To(released + 1.6, [&](double t) {
    if (t < released + 0.1) return;
    const double x = -run.Get(run.place(0).error)(axis);
    if (!rows.empty()) sum += 5e-3 * 0.5 * (x + rows.back()(0));
    rows.emplace_back(x, sum, run.Get(run.place(0).velocity)(axis));
  });
  EXPECT_FALSE(run.Get(run.tasks().touched));
  Eigen::MatrixXd A(rows.size(), 3);
  Eigen::VectorXd b(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    A.row(static_cast<Eigen::Index>(i)) << -rows[i](0), -rows[i](1), 1;
    b(static_cast<Eigen::Index>(i)) = rows[i](2);
  }
  const Vector3d found = A.colPivHouseholderQr().solve(b);
  const double omega = std::sqrt(found(1));
  return {omega, found(0) / (2 * omega)};
}

TEST(ContactControl, GivesEachAxisTheFrequencyAndTheDampingOfItsInertia) {
  const Vector3d m_d(20, 3, 10);
  const std::vector<std::string> forces{"[20 N, 0, 0]", "[0, 20 N, 0]", "[0, 0, 20 N]"};
  for (int axis = 0; axis < 3; ++axis) {
    const Fit fit = Identify(axis, forces[static_cast<std::size_t>(axis)]);
    const double omega = std::sqrt(500 / m_d(axis)), zeta = 80 / (2 * std::sqrt(500 * m_d(axis)));
    // A tick of 5 ms and half of one that it is held, beside 1/ω_n of 77 ms and more.
    EXPECT_NEAR(fit.omega, omega, 0.1 * omega) << axis;
    EXPECT_NEAR(fit.zeta, zeta, 0.1 * zeta) << axis;
  }
}

TEST(ContactControl, TellsTwoContactsApart) {
  Course run({{"controller.smallest_lever", "0.02"},
              {"environment", "[" + Push("link_4", "[0, 25 N, 0]", 2, 3) + ", " +
                                  Push("end_effector_link", "[0, 0, -15 N]", 2.5, 2.5) + "]"}});
  run.To(4.2);
  std::array<double, 2> squares{}, largest{};
  int ticks = 0;
  run.To(4.9, [&](double) {
    ++ticks;
    for (std::size_t i : {0U, 1U}) {
      const Force observed = run.Get(run.place(i).observed_error);
      squares[i] += observed.squaredNorm();
      largest[i] = std::max(largest[i], (run.Get(run.place(i).force_error) - observed).norm());
    }
  });
  EXPECT_EQ(run.Get(run.tasks().contacts).count(), 2);
  const ContactObservability& seen = run.Get(run.tasks().observability);
  EXPECT_EQ(seen.rows, 6);
  EXPECT_LT(seen.rank, 6) << "the elbow cannot feel a force along the upper arm";
  for (std::size_t i : {0U, 1U}) {
    // The residual's noise over the smallest lever arms of both points together: 0.35 N·m over
    // 0.15 m of joints 1 and 3, 0.05 N·m over 0.03 m of joint 6.
    EXPECT_LT(std::sqrt(squares[i] / ticks), 3) << i;
    // The rest is what of both forces no joint feels, less of it than there is.
    EXPECT_LT(largest[i], std::hypot(25, 15)) << i;
  }
}

const std::string kForce =
    "!Force {wanted: !Compatible {force: 15, floor: 3}, speed_limit: 1, way_limit: 0.5}";

TEST(ContactControl, PressesAsHardAsItIsTold) {
  Course run(
      With(kIdeal, {{"controller.behavior", kForce},
                    {"controller.smallest_lever", "0.02"},  // the arm is stretched
                    {"environment",
                     "[!Hand {link: link_6, stiffness: [60, 60, 60], damping: 10, start_s: 2,"
                     " duration_s: 4, path: [{after_s: 1, by: [0, 0.35, 0]}]}]"}}));
  run.To(5.9);
  EXPECT_EQ(run.Get(run.place(0).status), ContactForceStatus::Regulating);
  // The mode of law and hand decays with k_f k_e/(k_d + k_f d), 4.8 1/s, which leaves nothing after
  // 2.9 s; 1 % is for the direction along which the stretched arm hardly moves.
  const double off = 0.01 * 15;
  EXPECT_NEAR(run.Get(run.place(0).force).norm(), 15, off);
  EXPECT_NEAR(run.Get(run.place(0).wanted).norm(), 15, 1e-9);
  const double speed = 4.1 * off / (10.5 + 4.1 * 10);  // k_f ΔF/(k_d + k_f d)
  EXPECT_LT(run.Get(run.place(0).velocity).norm(), speed);
  EXPECT_LT(run.Get(run.place(0).observed_error).norm(), 60 * speed / 50);  // k_e ẋ/K_I, the lag
}

TEST(ContactControl, TheGuardEndsADrift) {
  Course run(With(
      kIdeal, {{"controller.behavior",
                "!Force {wanted: !Fixed {force: [0, 15 N, 0]}, speed_limit: 0.4, way_limit: 0.3}"},
               {"environment", "[" + Push("link_6", "[15 N, 0, 0]", 2, 3) + "]"}}));
  ContactForceStatus worst = ContactForceStatus::Idle;
  double way = 0;
  run.To(5.9, [&](double t) {
    if (t < 4.9) worst = std::max(worst, run.Get(run.place(0).status));
    way = std::max(way, run.Get(run.place(0).error).norm());
  });
  EXPECT_GE(worst, ContactForceStatus::TooFast);
  EXPECT_LT(way, 0.45) << "the limit, and the way to stop from 0.4 m/s";
  EXPECT_EQ(run.Get(run.place(0).status), ContactForceStatus::Holding);
}

TEST(ContactControl, GoesOnTheSameAfterARestore) {
  for (const std::string& behavior : {std::string("!Impedance {inertia: 5}"), kForce}) {
    Course run({{"controller.behavior", behavior},
                {"environment", "[" + Push("link_6", "[0, 20 N, 0]", 1.6, 2) + "]"}});
    run.To(1.9);
    EXPECT_TRUE(run.Get(run.tasks().touched));
    const Context snapshot = run.sim.Snapshot();
    run.sim.AdvanceTo(2.4);
    const Context end = run.sim.Snapshot();
    run.sim.Restore(snapshot);
    run.sim.AdvanceTo(2.4);
    EXPECT_TRUE(run.sim.Snapshot() == end) << behavior;
  }
}

TEST(ContactControl, RunsOffTheHeap) {
  for (const std::string& behavior : {std::string("!Impedance {inertia: 5}"), kForce}) {
    Course run({{"controller.behavior", behavior},
                {"environment", "[" + Push("link_6", "[0, 20 N, 0]", 1.6, 2) + "]"}});
    run.To(1.9);
    EXPECT_TRUE(run.Get(run.tasks().touched));
    const long before = Allocations();
    for (int i = 0; i < 100; ++i) run.sim.AdvanceThroughTick();
    EXPECT_EQ(Allocations() - before, 0) << behavior;
  }
}

TEST(ContactControl, RefusesWhatDoesNotFit) {
  EXPECT_EQ(ErrorOfSetting({}), "no error");
  EXPECT_THAT(ErrorOfSetting({{"controller.threshold", "[1, 2]"}}),
              HasSubstr("threshold must be a number or one for each of the 7 joints"));
  EXPECT_THAT(ErrorOfSetting({{"controller.release", "2"}}), HasSubstr("release"));
  EXPECT_THAT(ErrorOfSetting({{"controller.smallest_lever", "0"}}), HasSubstr("smallest_lever"));
  EXPECT_THAT(ErrorOfSetting({{"controller.tare_until_s", "0.5"}}), HasSubstr("until_s"));
  EXPECT_THAT(ErrorOfSetting({{"controller.behavior", "!Impedance {inertia: -1}"}}),
              HasSubstr("inertia"));
  EXPECT_THAT(ErrorOfSetting({{"controller.tool", "end_effector"}}),
              HasSubstr("end_effector_link"));
}

}  // namespace
}  // namespace pliant
