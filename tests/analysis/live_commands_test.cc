#include "pliant/analysis/live_commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "pliant/plants/shared_file.h"
#include "pliant/tests/support/error_of.h"

namespace pliant::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using Json = LiveCommands::Json;
using TunableKind = TunableValue::Kind;

TunableValue Named(const char* path, TunableKind kind, std::vector<double> start) {
  TunableValue of;
  of.path = path;
  of.kind = kind;
  of.elements.assign(start.size(), "");
  of.units.assign(start.size(), "");
  of.start = std::move(start);
  return of;
}

LiveCommands::Options Everything(bool control = true) {
  TunableValue word = Named("mode", TunableKind::Word, {0});
  word.words = {"stiff", "soft"};
  TunableValue whole = Named("count", TunableKind::Number, {3});
  whole.whole = true;
  return {.tunables = {Named("gain", TunableKind::Number, {1}), Named("on", TunableKind::Flag, {1}),
                       word, whole, Named("limits", TunableKind::Numbers, {1, 2})},
          .pushed = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf")),
          .control = control,
          .stop = [] {}};
}

void Set(LiveCommands& commands, const char* name, const Json& value) {
  commands.SetParameter(commands.parameters().Find(name), value);
}

std::vector<double> Numbers(const LiveCommands::Change& change) {
  return {change.numbers.begin(), change.numbers.end()};
}

TEST(LiveCommands, HandsWhatIsSetToTheRunInOrder) {
  LiveCommands commands(Everything());
  Set(commands, "gain", 2.5);
  Set(commands, "limits", Json::array({3, 4}));
  Set(commands, "mode", "soft");
  Set(commands, "on", false);
  std::vector<int> targets;
  std::vector<std::vector<double>> numbers;
  while (const auto change = commands.Next()) {
    targets.push_back(change->target);
    numbers.push_back(Numbers(*change));
  }
  EXPECT_THAT(targets, ElementsAre(0, 4, 2, 1));
  EXPECT_THAT(numbers,
              ElementsAre(ElementsAre(2.5), ElementsAre(3, 4), ElementsAre(1), ElementsAre(0)));
  EXPECT_EQ(commands.parameters().Value(4), Json::array({3.0, 4.0}));
  EXPECT_EQ(commands.parameters().Value(2), "soft");
}

TEST(LiveCommands, RefusesWhatIsNotOfTheKindOfTheParameter) {
  LiveCommands commands(Everything());
  const auto refusal = [&](const char* name, const Json& value) {
    return ErrorOf([&] { Set(commands, name, value); });
  };
  EXPECT_EQ(refusal("gain", "x"), "gain: expected a finite number, got \"x\"");
  EXPECT_EQ(refusal("gain", nullptr), "gain: expected a finite number, got null");
  EXPECT_EQ(refusal("gain", std::numeric_limits<double>::infinity()),
            "gain: expected a finite number, got null");
  EXPECT_EQ(refusal("count", 2.5), "count: expected a whole number, got 2.5");
  EXPECT_EQ(refusal("count", 1e12), "count: expected a whole number, got 1000000000000.0");
  EXPECT_EQ(refusal("on", 1), "on: expected true or false, got 1");
  EXPECT_EQ(refusal("mode", "hard"), "mode: expected one of stiff, soft, got \"hard\"");
  EXPECT_EQ(refusal("limits", Json::array({1})), "limits: expected 2 finite numbers, got [1]");
  EXPECT_EQ(refusal("gain", Json::object({{"a", 1}})),
            "gain: expected a finite number, got an object");
  EXPECT_EQ(refusal("limits", Json::parse("[[[1]],2]")),
            "limits: expected 2 finite numbers, got an array of 2");
  EXPECT_EQ(refusal("limits", Json::array({1, "2"})),
            "limits: expected 2 finite numbers, got [1,\"2\"]");
  EXPECT_EQ(ErrorOf([&] { commands.parameters().Find("gian"); }),
            "there is no parameter 'gian'; did you mean 'gain'?");
  EXPECT_FALSE(commands.Next().has_value());
  EXPECT_EQ(commands.parameters().Value(0), 1.0);
}

TEST(LiveCommands, ChangesNothingWithoutControl) {
  LiveCommands commands(Everything(false));
  EXPECT_EQ(ErrorOf([&] { Set(commands, "gain", 2); }),
            "gain cannot be set: give --control to allow that");
  EXPECT_EQ(ErrorOf([&] { commands.Publish("/push", Json::object(), nullptr); }),
            "/push: give --control to allow that");
  EXPECT_FALSE(commands.pushes());
  EXPECT_FALSE(commands.Next().has_value());
}

TEST(LiveCommands, StopsWithoutControlToo) {
  int stops = 0;
  LiveCommands::Options o = Everything(false);
  o.stop = [&] { ++stops; };
  LiveCommands commands(o);
  commands.Publish("/pliant/stop", Json::object(), nullptr);
  EXPECT_EQ(stops, 1);
}

TEST(LiveCommands, AcknowledgesWithControlWhereThereIsASupervisor) {
  int words = 0;
  LiveCommands::Options o = Everything();
  EXPECT_EQ(ErrorOf([&] { LiveCommands(o).Publish("/pliant/acknowledge", {}, nullptr); }),
            "there is nothing to acknowledge: the run has no supervisor");
  o.acknowledge = [&] { ++words; };
  LiveCommands(o).Publish("/pliant/acknowledge", {}, nullptr);
  EXPECT_EQ(words, 1);
  o.control = false;
  EXPECT_EQ(ErrorOf([&] { LiveCommands(o).Publish("/pliant/acknowledge", {}, nullptr); }),
            "it cannot be acknowledged here: give --control to allow that");
}

Json PushOf(double force, const char* link = "forearm_link") {
  return {{"link", link}, {"point", {0, 0, 0.1}}, {"force", {force, 0, 0}}};
}

TEST(LiveCommands, TurnsAPushIntoAContactForceOfTheLink) {
  LiveCommands commands(Everything());
  commands.Publish("/push", PushOf(12), &commands);
  const auto change = commands.Next();
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->target, LiveCommands::kPush);
  const RobotModel gen3 = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf"));
  EXPECT_THAT(Numbers(*change),
              ElementsAre(gen3.link_index("forearm_link"), 0, 0, 0.1, 12, 0, 0, 0, 0, 0));
}

TEST(LiveCommands, LetsGoOfAPushThatIsOldOrWhoseClientHasLeft) {
  for (const bool leaves : {false, true}) {
    LiveCommands commands(Everything());
    const int client = 0, other = 0;
    commands.Publish("/push", PushOf(12), &client);
    const auto now = LiveCommands::Clock::now();
    commands.LetGoOfOld(now);
    commands.Leave(&other);
    commands.LetGoOfOld(now);
    ASSERT_TRUE(commands.Next().has_value());
    EXPECT_FALSE(commands.Next().has_value());
    if (leaves) commands.Leave(&client);
    commands.LetGoOfOld(leaves ? now : now + std::chrono::milliseconds(300));
    const auto change = commands.Next();
    ASSERT_TRUE(change.has_value());
    EXPECT_EQ(change->numbers[0], -1);
    EXPECT_FALSE(commands.Next().has_value());
    commands.LetGoOfOld(now + std::chrono::seconds(9));
    EXPECT_FALSE(commands.Next().has_value());
  }
}

TEST(LiveCommands, RefusesAPushThatIsNone) {
  LiveCommands commands(Everything());
  const auto refusal = [&](const Json& message) {
    return ErrorOf([&] { commands.Publish("/push", message, nullptr); });
  };
  const std::string shape =
      "/push: expected {\"link\": name, \"point\": [x, y, z], \"force\": [x, y, z]}";
  EXPECT_EQ(refusal(Json::array()), shape);
  EXPECT_EQ(refusal({{"link", 3}}), shape);
  EXPECT_EQ(refusal(PushOf(1, "forarm_link")),
            "/push: there is no link 'forarm_link'; did you mean 'forearm_link'?");
  EXPECT_EQ(refusal(PushOf(201)),
            "/push: force must be three numbers, of a length of at most 200 N");
  Json far = PushOf(1);
  far["point"] = {0, 3, 0};
  EXPECT_EQ(refusal(far), "/push: point must be three numbers, of a length of at most 2 m");
  far["point"] = {0, "a", 0};
  EXPECT_THAT(refusal(far), StartsWith("/push: point must be"));
  EXPECT_FALSE(commands.Next().has_value());

  LiveCommands::Options fixed = Everything();
  fixed.pushed.reset();
  EXPECT_EQ(ErrorOf([&] { LiveCommands(fixed).Publish("/push", PushOf(1), nullptr); }),
            "/push: nothing can be pushed here but a simulated arm");
}

TEST(LiveCommands, RefusesTopicsThatNothingListensTo) {
  LiveCommands commands(Everything());
  EXPECT_EQ(ErrorOf([&] { commands.Publish("/cmd_vel", {}, nullptr); }),
            "nothing listens to the topic '/cmd_vel'; expected /push, /pliant/stop or "
            "/pliant/acknowledge");
}

TEST(LiveCommands, RefusesChangesThatComeFasterThanTheRunTakesThem) {
  LiveCommands commands(Everything());
  std::string error = "no error";
  for (int i = 0; i < 20'000 && error == "no error"; ++i)
    error = ErrorOf([&] { Set(commands, "gain", i); });
  EXPECT_EQ(error, "gain was not set: changes come faster than the run takes them");
  const Json last = commands.parameters().Value(0);
  double taken = -1;
  while (const auto change = commands.Next()) taken = change->numbers[0];
  EXPECT_EQ(taken, last);  // what clients are told is what the run has
}

}  // namespace
}  // namespace pliant::internal
