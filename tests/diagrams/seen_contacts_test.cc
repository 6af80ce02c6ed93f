// Contacts that a depth camera sees, in a scenario.

#include "pliant/diagrams/seen_contacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/diagrams/scenario.h"
#include "pliant/plants/parameter_file.h"
#include "pliant/systems/simulator.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

constexpr double kHand = 0.04;  // [m] radius of the hand

enum class By { ContactControl, Compliance };

/// An arm that is pushed, with contacts seen by a camera.
std::string ScenarioText(const std::string& push, const std::string& camera = "",
                         By by = By::ContactControl) {
  const std::string threshold = "threshold: [3, 3, 1.2, 1.2, 0.6, 0.6, 0.6]";
  const std::string localization = "localization: !DepthCamera {contacts: 1" + camera + "}";
  const std::string controller =
      by == By::ContactControl
          ? "!ContactControl\n  tool: end_effector_link\n  " + threshold + "\n  " + localization
          : "!Compliance\n  tool: end_effector_link\n  pose: {weight: 0}\n"
            "  posture: {damping: 20}\n  contacts:\n    " +
                threshold + "\n    " + localization;
  return R"(robot: lwr
station: !SimulatedArm {engine: recursive}
controller: )" +
         controller + R"(
environment:
  - !Push {link: )" +
         push + R"(, start_s: 2, duration_s: 2}
integrator: {method: dormand_prince}
duration_s: 5
)";
}

Scenario ScenarioIn(const std::string& text) {
  ParameterFile file = ParameterFile::ReadText(text, "s.yaml");
  Scenario scenario;
  file.Fill(scenario);
  return scenario;
}

struct Scene {
  explicit Scene(const std::string& text)
      : scenario{ScenarioIn(text)},
        scene{scenario},
        diagram{scene.builder.Build()},
        sim{diagram, {.integrator = scenario.integrator}},
        tasks{scene.contact ? *scene.contact->contact_tasks : *scene.control->contact_tasks} {}

  Scenario scenario;
  ScenarioDiagram scene;
  Diagram diagram;
  Simulator sim;
  const ContactTasks& tasks;
};

class SeenContacts : public testing::TestWithParam<By> {};

TEST_P(SeenContacts, AreFoundAsLongAsTheyLastAndTheirForceWithThem) {
  Scene run(ScenarioText("link_6, force: [0, -20 N, 0]", "", GetParam()));
  run.sim.AdvanceTo(1.9);
  EXPECT_EQ(run.sim.Get(run.tasks.contacts).count(), 0);
  for (double t = 3; t < 3.7; t += 0.1) {
    run.sim.AdvanceTo(t);
    EXPECT_EQ(run.sim.Get(run.tasks.contacts).count(), 1) << t;
    EXPECT_TRUE(run.sim.Get(run.tasks.sight).seen[0]) << t;
    EXPECT_LT(run.sim.Get(run.tasks.place_error), kHand) << t;
    // 40 mm of 20 N over the smallest lever arm that counts, 0.22 m, and 2 N of noise.
    EXPECT_LT(run.sim.Get(run.tasks.places[0]->force_error).norm(), 5.6) << t;
  }
  run.sim.AdvanceTo(4.9);
  EXPECT_EQ(run.sim.Get(run.tasks.contacts).count(), 0);
  EXPECT_FALSE(run.sim.Get(run.tasks.sight).unseen);
}

TEST_P(SeenContacts, RunWithoutHeapAndTheSameAgainAfterARestore) {
  Scene run(ScenarioText("link_6, force: [0, -20 N, 0]", "", GetParam()));
  run.sim.AdvanceTo(3);
  EXPECT_EQ(run.sim.Get(run.tasks.contacts).count(), 1);
  const Context snapshot = run.sim.Snapshot();
  const long before = Allocations();
  run.sim.AdvanceTo(3.2);
  EXPECT_EQ(Allocations(), before);
  const Context end = run.sim.Snapshot();
  run.sim.Restore(snapshot);
  run.sim.AdvanceTo(3.2);
  EXPECT_TRUE(run.sim.Snapshot() == end);
}

INSTANTIATE_TEST_SUITE_P(By, SeenContacts, testing::Values(By::ContactControl, By::Compliance),
                         [](const auto& by) {
                           return by.param == By::ContactControl ? "ContactControl" : "Compliance";
                         });

TEST(SeenByCamera, OfTwoCamerasOneSeesWhatTheOtherDoesNot) {
  // On link 3, pushed away from one camera and towards the other.
  const std::string push = "link_3, point: [0, 0, 0.1], force: [0, -25 N, 0]";
  Scene beside(ScenarioText(push, ", position: [0, 2, 0.6], target: [0, 0, 0.6]"));
  beside.sim.AdvanceTo(3.5);
  EXPECT_EQ(beside.sim.Get(beside.tasks.contacts).count(), 1);
  EXPECT_LT(beside.sim.Get(beside.tasks.place_error), kHand);
  Scene hidden(ScenarioText(push, ", position: [0, -2, 0.6], target: [0, 2, 0.6]"));
  hidden.sim.AdvanceTo(3.5);
  EXPECT_TRUE(hidden.sim.Get(hidden.tasks.touched));
  EXPECT_EQ(hidden.sim.Get(hidden.tasks.contacts).count(), 0);
  EXPECT_TRUE(hidden.sim.Get(hidden.tasks.sight).unseen);
}

TEST(SeenByCamera, CanBeSavedAndRestoredWithoutThePicture) {
  const TemporaryDirectory folder;
  const auto file = folder.path() / "snapshot";
  Scene run(ScenarioText("link_6, force: [0, -20 N, 0]"));
  run.sim.AdvanceTo(3);
  run.sim.Snapshot().Save(file);  // the picture itself has no place in it
  run.sim.AdvanceTo(3.2);
  const Contacts found = run.sim.Get(run.tasks.contacts);
  Context restored = run.sim.Snapshot();
  restored.Load(file);
  run.sim.Restore(restored);
  run.sim.AdvanceTo(3.2);
  EXPECT_EQ(run.sim.Get(run.tasks.contacts).at[0].point, found.at[0].point);
  EXPECT_EQ(run.sim.Get(run.tasks.contacts).at[0].force, found.at[0].force);
}

TEST(SeenByCamera, IsRefusedWhereTheCameraLooksAtItself) {
  EXPECT_THAT(ErrorOf([] {
                Scene run(ScenarioText("link_6, force: [0, -20 N, 0]",
                                       ", position: [1, 0, 1], target: [1, 0, 1]"));
              }),
              testing::HasSubstr("a camera looks at a point away from it, got 1 0 1"));
}

}  // namespace
}  // namespace pliant
