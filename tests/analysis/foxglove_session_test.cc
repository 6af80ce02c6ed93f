#include "pliant/analysis/foxglove_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <optional>
#include <random>

#include "pliant/analysis/write_file.h"
#include "pliant/plants/shared_file.h"

namespace pliant::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Json = FoxgloveSession::Json;
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

/// A server of two channels and three parameters, and a client.
struct Scene {
  Scene() {
    const auto schema = channels.AddSchema("pliant/msg/Number", "ros2msg", "float64 data");
    first = channels.AddChannel(schema, "/first", "cdr", {});
    second = channels.AddChannel(schema, "/second", "cdr", {});
    Connect();
  }

  void Connect() {
    session.emplace(FoxgloveSession::Options{
        .name = "test",
        .session = "7",
        .channels = &channels,
        .commands = &commands,
        .send = [this](FoxgloveSession::Frame frame) { sent.push_back(std::move(frame)); },
        .has_room = [this] { return has_room; },
        .parameters_changed =
            [this](const std::set<std::size_t>& which) { session->ParametersChanged(which); },
        .subscribed = [](FoxgloveSession&, const LiveChannel&) {}});
  }

  /// What it is told until now, and not again.
  std::vector<Json> Told() {
    std::vector<Json> messages;
    for (const FoxgloveSession::Frame& frame : std::exchange(sent, {}))
      if (frame.text) messages.push_back(Json::parse(frame.content));
    return messages;
  }
  /// The only message to what is said.
  Json Answer(const Json& message) {
    Told();
    session->HearText(message.dump());
    const std::vector<Json> told = Told();
    return told.size() == 1 ? told.front() : Json(told);
  }

  static std::vector<TunableValue> Tunables() {
    TunableValue mode = Named("mode", TunableKind::Word, {0});
    mode.words = {"stiff", "soft"};
    return {Named("gain", TunableKind::Number, {1}), mode,
            Named("limits", TunableKind::Numbers, {1, 2})};
  }

  std::vector<FoxgloveSession::Frame> sent;
  LiveCommands commands{{.tunables = Tunables(),
                         .pushed = RobotModel::FromUrdf(ModelFile("gen3/gen3_7dof.urdf")),
                         .control = true,
                         .stop = [this] { stopped = true; }}};
  LiveChannels channels{[this](const LiveChannel& channel) {
                          if (session) session->Advertise(channel);
                        },
                        [this](const LiveChannel& to, std::int64_t t, std::string_view content) {
                          if (session) session->Deliver(to, t, content);
                        }};
  std::optional<FoxgloveSession> session;
  std::uint16_t first = 0, second = 0;
  bool stopped = false, has_room = true;
};

std::string Head(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string head(1, '\1');
  head.append(reinterpret_cast<const char*>(&subscription), 4);
  return head.append(reinterpret_cast<const char*>(&time_ns), 8);
}

TEST(FoxgloveSession, IsToldWhoServesAndWhatThereIs) {
  Scene scene;
  const std::vector<Json> told = scene.Told();
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0]["op"], "serverInfo");
  EXPECT_EQ(told[0]["sessionId"], "7");
  EXPECT_EQ(told[0]["capabilities"], Json({"clientPublish", "parameters", "parametersSubscribe"}));
  EXPECT_EQ(told[1]["op"], "advertise");
  EXPECT_EQ(told[1]["channels"][1], Json({{"id", 2},
                                          {"topic", "/second"},
                                          {"encoding", "cdr"},
                                          {"schemaName", "pliant/msg/Number"},
                                          {"schema", "float64 data"},
                                          {"schemaEncoding", "ros2msg"}}));
}

TEST(FoxgloveSession, IsToldOfAChannelThatBeginsLater) {
  Scene scene;
  scene.Told();
  scene.channels.AddChannel(1, "/third", "cdr", {});
  const std::vector<Json> told = scene.Told();
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0]["channels"][0]["topic"], "/third");
}

TEST(FoxgloveSession, GetsTheMessagesOfWhatItSubscribesTo) {
  Scene scene;
  scene.session->HearText(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":2}]})");
  scene.sent.clear();
  scene.channels.Tell(scene.first, 5, "one");
  scene.channels.Tell(scene.second, 6, "two");
  scene.channels.Tell(scene.second, 7, "three");
  ASSERT_EQ(scene.sent.size(), 2u);
  EXPECT_FALSE(scene.sent[0].text);
  EXPECT_EQ(scene.sent[0].content, Head(9, 6) + "two");
  EXPECT_EQ(scene.sent[1].content, Head(9, 7) + "three");

  scene.session->HearText(R"({"op":"unsubscribe","subscriptionIds":[9]})");
  scene.sent.clear();
  scene.channels.Tell(scene.second, 8, "four");
  EXPECT_TRUE(scene.sent.empty());
}

TEST(FoxgloveSession, GetsTheOnlyMessageOfAChannelHoweverLateItComes) {
  Scene scene;
  scene.channels.Tell(scene.first, 5, "the robot");
  scene.channels.Tell(scene.second, 5, "old");
  scene.channels.Tell(scene.second, 6, "newer");
  scene.sent.clear();
  scene.session->HearText(
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":2}]})");
  ASSERT_EQ(scene.sent.size(), 1u);
  EXPECT_EQ(scene.sent[0].content, Head(1, 5) + "the robot");
}

TEST(FoxgloveSession, SubscribesToAChannelOnce) {
  Scene scene;
  const Json twice{
      {"op", "subscribe"},
      {"subscriptions", {{{"id", 1}, {"channelId", 2}}, {{"id", 3}, {"channelId", 2}}}}};
  EXPECT_EQ(scene.Answer(twice)["message"], "this client has subscribed to channel 2 already");
  EXPECT_EQ(scene.channels.Find(2)->subscribers, 1);
}

TEST(FoxgloveSession, GetsNoMessageWhileItIsTooSlowForThem) {
  Scene scene;
  scene.session->HearText(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":2}]})");
  scene.sent.clear();
  scene.has_room = false;
  scene.channels.Tell(scene.second, 6, "two");
  EXPECT_TRUE(scene.sent.empty());
  scene.has_room = true;
  scene.channels.Tell(scene.second, 7, "three");
  EXPECT_EQ(scene.sent.size(), 1u);
}

TEST(FoxgloveSession, AnswersLongNonsenseAsQuicklyAsShort) {
  Scene scene;
  const Json told =
      scene.Answer({{"op", "getParameters"}, {"parameterNames", {std::string(60'000, 'x')}}});
  EXPECT_EQ(told["message"],
            "there is no parameter '" + std::string(200, 'x') + "'; did you mean 'gain'?");
}

TEST(FoxgloveSession, ReadsAndSetsParameters) {
  Scene scene;
  EXPECT_EQ(
      scene.Answer({{"op", "getParameters"}, {"parameterNames", {"gain", "limits"}}, {"id", "x"}}),
      Json({{"op", "parameterValues"},
            {"parameters",
             {{{"name", "gain"}, {"value", 1.0}, {"type", "float64"}},
              {{"name", "limits"}, {"value", {1.0, 2.0}}, {"type", "float64_array"}}}},
            {"id", "x"}}));
  EXPECT_EQ(scene.Answer({{"op", "getParameters"}, {"parameterNames", Json::array()}})["parameters"]
                .size(),
            3u);
  EXPECT_EQ(scene.Answer({{"op", "setParameters"},
                          {"parameters", {{{"name", "mode"}, {"value", "soft"}}}},
                          {"id", "y"}})["parameters"],
            Json({{{"name", "mode"}, {"value", "soft"}}}));
  EXPECT_EQ(scene.commands.Next()->target, 1);
}

TEST(FoxgloveSession, IsToldOfChangesOfParametersItSubscribesTo) {
  Scene scene;
  const Json set{{"op", "setParameters"}, {"parameters", {{{"name", "gain"}, {"value", 3}}}}};
  EXPECT_EQ(scene.Answer(set), Json::array());
  scene.session->HearText(R"({"op":"subscribeParameterUpdates","parameterNames":["gain"]})");
  EXPECT_EQ(scene.Answer(set)["parameters"][0]["value"], 3.0);
  scene.session->HearText(R"({"op":"unsubscribeParameterUpdates","parameterNames":["gain"]})");
  EXPECT_EQ(scene.Answer(set), Json::array());
}

TEST(FoxgloveSession, IsToldWhyAParameterIsNotSetAndTheValueThatHolds) {
  Scene scene;
  const Json told = scene.Answer(
      {{"op", "setParameters"}, {"parameters", {{{"name", "gain"}, {"value", "high"}}}}});
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0], Json({{"op", "status"},
                           {"level", 2},
                           {"message", "gain: expected a finite number, got \"high\""}}));
  EXPECT_EQ(told[1]["parameters"][0]["value"], 1.0);
}

TEST(FoxgloveSession, PublishesOnTopicsItHasAdvertised) {
  Scene scene;
  scene.session->HearText(
      R"({"op":"advertise","channels":[{"id":3,"topic":"/pliant/stop","encoding":"json"}]})");
  scene.session->HearBinary(std::string("\1\3\0\0\0{}", 7));
  EXPECT_TRUE(scene.stopped);
}

TEST(FoxgloveSession, LetsGoOfWhatItPushesWhenItLeaves) {
  Scene scene;
  scene.session->HearText(
      R"({"op":"advertise","channels":[{"id":7,"topic":"/push","encoding":"json"}]})");
  scene.session->HearBinary(std::string("\1\7\0\0\0", 5) +
                            R"({"link":"forearm_link","point":[0,0,0],"force":[10,0,0]})");
  ASSERT_TRUE(scene.commands.Next().has_value());
  scene.session.reset();
  scene.commands.LetGoOfOld(LiveCommands::Clock::now());
  const auto change = scene.commands.Next();
  ASSERT_TRUE(change.has_value());
  EXPECT_EQ(change->numbers[0], -1);
}

TEST(FoxgloveSession, SaysWhatIsWrongWithAMessage) {
  struct Case {
    const char* said;
    const char* told;
  };
  for (const auto& [said, told] : std::vector<Case>{
           {"hello", "a message must be a JSON object"},
           {"[1]", "a message must be a JSON object"},
           {"{}", "expected a field 'op'"},
           {R"({"op":3})", "'op' must be a string"},
           {R"({"op":"dance"})", "op 'dance' is not served here"},
           {R"({"op":"subscribe"})", "expected a field 'subscriptions'"},
           {R"({"op":"subscribe","subscriptions":3})", "'subscriptions' must be an array"},
           {R"({"op":"subscribe","subscriptions":[3]})", "a subscription must be an object"},
           {R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
            "the id of a subscription must be a whole number of 32 bits"},
           {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":77}]})",
            "there is no channel 77"},
           {R"({"op":"getParameters","parameterNames":[],"id":[[[1]]]})",
            "'id' must be a string of at most 256 bytes"},
           {R"({"op":"unsubscribe","subscriptionIds":[5]})", "there is no subscription 5"},
           {R"({"op":"advertise","channels":[{"id":1,"topic":"/push","encoding":"cdr"}]})",
            "/push: the encoding must be json, got 'cdr'"},
           {R"({"op":"advertise","channels":[{"id":1,"topic":"/x","encoding":"json"}]})",
            "nothing listens to the topic '/x'; expected /push, /pliant/stop or "
            "/pliant/acknowledge"},
           {R"({"op":"unadvertise","channelIds":[1]})",
            "channel 1 was not advertised by this client"},
           {R"({"op":"getParameters","parameterNames":3})", "'parameterNames' must be an array"},
           {R"({"op":"setParameters","parameters":[3]})", "a parameter must be an object"},
           {R"({"op":"setParameters","parameters":[{"name":"gain"}]})",
            "expected a field 'value'"}}) {
    Scene scene;
    scene.Told();
    scene.session->HearText(said);
    const std::vector<Json> answers = scene.Told();
    ASSERT_FALSE(answers.empty()) << said;
    EXPECT_EQ(answers[0]["message"], told) << said;
    EXPECT_EQ(answers[0]["level"], 2) << said;
  }
  Scene scene;
  scene.Told();
  scene.session->HearBinary("\2abcdefg");
  scene.session->HearBinary(std::string("\1\5\0\0\0{}", 7));
  const std::vector<Json> answers = scene.Told();
  ASSERT_EQ(answers.size(), 2u);
  EXPECT_EQ(answers[0]["message"],
            "a binary message must begin with 1 and the number of a channel");
  EXPECT_EQ(answers[1]["message"], "channel 5 was not advertised by this client");
}

/// Frames that clients send, from a folder beside this file.
std::vector<std::pair<bool, std::string>> Corpus() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(__FILE__).parent_path() / "foxglove_frames"))
    files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<std::pair<bool, std::string>> frames;
  for (const auto& file : files) frames.emplace_back(file.extension() == ".json", ReadFile(file));
  return frames;
}

std::string Spoilt(std::string frame, const std::string& other, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (auto times = 1 + below(4); times > 0; --times) switch (random() % 4) {
      case 0:
        if (!frame.empty()) frame[below(frame.size())] = static_cast<char>(random());
        break;
      case 1:
        frame.erase(below(frame.size()), 1 + below(8));
        break;
      case 2:
        frame.insert(below(frame.size()), other.substr(below(other.size()), below(20)));
        break;
      default:
        frame.resize(below(frame.size() + 1));
    }
  return frame;
}

TEST(FoxgloveSession, SurvivesAnythingAndGoesOnServing) {
  const auto corpus = Corpus();
  ASSERT_GE(corpus.size(), 10u);
  std::mt19937 random(1);
  Scene scene;
  for (int k = 0; k < 20'000; ++k) {
    const auto& [text, frame] = corpus[random() % corpus.size()];
    const auto& [ignored, other] = corpus[random() % corpus.size()];
    const std::string said = k < 100 ? frame : Spoilt(frame, other, random);
    if (text)
      scene.session->HearText(said);
    else
      scene.session->HearBinary(said);
    scene.channels.Tell(scene.first, k, "message");
    for (const FoxgloveSession::Frame& sent : std::exchange(scene.sent, {})) {
      if (!sent.text) continue;
      ASSERT_TRUE(Json::accept(sent.content)) << sent.content;
    }
    while (scene.commands.Next()) continue;
  }
  EXPECT_EQ(scene.Answer({{"op", "getParameters"}, {"parameterNames", {"gain"}}})["op"],
            "parameterValues");
  scene.session.reset();
  for (const LiveChannel& channel : scene.channels.all()) EXPECT_EQ(channel.subscribers, 0);
}

}  // namespace
}  // namespace pliant::internal
