#include "pliant/analysis/live_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "pliant/analysis/replay.h"
#include "pliant/analysis/run_experiment.h"
#include "pliant/tests/support/allocations.h"
#include "pliant/tests/support/error_of.h"
#include "pliant/tests/support/temporary_directory.h"
#include "pliant/tests/support/web_client.h"

namespace pliant {
namespace {

using Json = nlohmann::json;

constexpr const char* kHolding = R"(
title: Holding
summary: An arm holds its pose.
robot: gen3
station: !SimulatedArm {ideal: true, engine: recursive}
controller: !Compliance {tool: tool_frame, estimate: "true", posture: {compliance: 1}}
duration_s: 60
)";

/// A client of the Foxglove protocol.
class Client {
 public:
  explicit Client(const std::string& url) : web_{PortOf(url)} { web_.Upgrade(web_.Host()); }

  void Say(const Json& message) { web_.SendFrame(message.dump()); }
  void Publish(const char* topic, const Json& message) {
    Say({{"op", "advertise"}, {"channels", {{{"id", 7}, {"topic", topic}, {"encoding", "json"}}}}});
    web_.SendFrame(std::string("\1\7\0\0\0", 5) + message.dump(), 2);
  }
  void Subscribe(const std::string& topic) {
    for (;;) {
      if (const auto id = channels_.find(topic); id != channels_.end()) {
        Say({{"op", "subscribe"},
             {"subscriptions", {{{"id", id->second}, {"channelId", id->second}}}}});
        return;
      }
      Text();
    }
  }
  /// The next message that is text.
  Json Text() {
    int opcode = 0;
    std::string frame;
    do {
      frame = web_.ReadFrame(&opcode);
      if (opcode == 8) throw std::runtime_error("it was closed");
    } while (opcode != 1);
    Json message = Json::parse(frame);
    if (message["op"] == "advertise")
      for (const Json& channel : message["channels"])
        channels_[channel["topic"]] = channel["id"].get<std::uint32_t>();
    return message;
  }
  /// The content of the next message of what it subscribes to.
  std::string Data(std::string_view topic) {
    for (;;) {
      int opcode = 0;
      const std::string frame = web_.ReadFrame(&opcode);
      if (opcode == 8) throw std::runtime_error("it was closed");
      if (opcode != 2) continue;
      std::uint32_t id = 0;
      std::memcpy(&id, frame.data() + 1, sizeof id);
      if (id == channels_.at(std::string(topic))) return frame.substr(13);
    }
  }

 private:
  static std::uint16_t PortOf(const std::string& url) {
    return static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  }
  WebClient web_;
  std::map<std::string, std::uint32_t> channels_;
};

/// A run that is shown until `act`, which is called when it goes on, returns.
template <class Act>
RunData Shown(const Act& act, bool control = true) {
  const TemporaryDirectory out;
  LiveView view({.port = 0, .control = control});
  std::exception_ptr failure;
  std::jthread client([&] {
    try {
      Client c(view.url());
      c.Subscribe("/pliant/run");
      c.Data("/pliant/run");
      act(c);
    } catch (...) {
      failure = std::current_exception();
    }
    view.RequestStop();
  });
  const auto logs = RunExperiment(ExperimentFile::ReadText(kHolding, "holding.yaml"),
                                  {.out = out.path(), .view = &view});
  client.join();
  if (failure) std::rethrow_exception(failure);
  return RunData::Read(logs.at(0));
}

Json SetOf(const char* name, const Json& value) {
  return {
      {"op", "setParameters"}, {"parameters", {{{"name", name}, {"value", value}}}}, {"id", "set"}};
}

ReplayResult ReplayOf(const RunData& run) {
  ScenarioDiagram scene(run.scenario);
  return Replay(std::move(scene.builder), "control", run.log);
}

TEST(LiveView, ChangesWhatTheRunDoesFromTheNextTickOnAndTheLogSaysSo) {
  const std::vector<double> stiffness{100, 100, 100, 100, 100, 100};
  const RunData run = Shown([&](Client& client) {
    client.Say(SetOf("control.pose.stiffness", stiffness));
    Json told;
    do told = client.Text();
    while (told["op"] != "parameterValues");
    EXPECT_EQ(told["parameters"][0]["value"], Json(stiffness));
    client.Data("/pliant/run");
  });
  EXPECT_FALSE(run.whole);
  const RecordedSignal& changed = run.log["control.pose.stiffness"];
  ASSERT_EQ(changed.times.size(), 1);
  EXPECT_EQ(changed.numbers, Eigen::VectorXd::Constant(6, 100));
  const ReplayResult replayed = ReplayOf(run);
  EXPECT_TRUE(replayed.identical()) << replayed.text();
}

TEST(LiveView, PushesTheArmAndTheLogCanBeReplayed) {
  const RunData run = Shown([&](Client& client) {
    client.Publish("/push",
                   {{"link", "forearm_link"}, {"point", {0, 0, 0}}, {"force", {0, 20, 0}}});
    client.Data("/pliant/run");
    client.Data("/pliant/run");
  });
  const Eigen::VectorXd force = run.log["live_push_1.force"]["force[y]"];
  EXPECT_EQ(force.maxCoeff(), 20);
  EXPECT_EQ(force(force.size() - 1), 0);  // let go of, a quarter of a second later
  // It gives way in its null space, where less than its 8 kg are moved: in a quarter of a second by
  // more than ½ (20/8) 0.25² m, of which a tenth is enough to tell it from an arm at rest.
  const auto q = run.log["arm.position"].numbers;
  EXPECT_GT((q.colwise() - q.col(0)).cwiseAbs().maxCoeff(), 0.008);
  const ReplayResult replayed = ReplayOf(run);
  EXPECT_TRUE(replayed.identical()) << replayed.text();
}

TEST(LiveView, HandsOutTheRowsOfItsPage) {
  std::vector<double> times;
  const RunData run = Shown([&](Client& client) {
    client.Subscribe("/pliant/rows");
    const std::string rows = client.Data("/pliant/rows");
    std::uint32_t count = 0;
    std::memcpy(&count, rows.data() + 4, sizeof count);
    std::vector<double> numbers(count);
    std::memcpy(numbers.data(), rows.data() + 12, count * sizeof(double));
    ASSERT_FALSE(numbers.empty());
    EXPECT_EQ(numbers[0], 0);  // all since the start
  });
}

TEST(LiveView, LetsNobodyChangeAnythingWithoutControl) {
  const RunData run = Shown(
      [&](Client& client) {
        client.Say(SetOf("control.pose.stiffness", std::vector<double>(6, 100.0)));
        Json told;
        do told = client.Text();
        while (told["op"] != "status");
        EXPECT_EQ(told["message"],
                  "control.pose.stiffness cannot be set: give --control to allow that");
        client.Publish("/push",
                       {{"link", "tool_frame"}, {"point", {0, 0, 0}}, {"force", {0, 9, 0}}});
        do told = client.Text();
        while (told["op"] != "status");
        EXPECT_EQ(told["message"], "/push: nothing can be pushed here but a simulated arm");
        client.Publish("/pliant/stop", Json::object());
      },
      false);
  EXPECT_FALSE(run.log.has("control.pose.stiffness"));
  EXPECT_FALSE(run.log.has("live_push_1.force"));
}

TEST(LiveView, TakesNothingFromTheHeapInATick) {
  if (!kCountsAllocations) return;  // a sanitizer has a heap of its own
  Scenario scenario = ExperimentFile::ReadText(kHolding, "holding.yaml").scenarios.front();
  LiveView view({.port = 0, .control = true});
  scenario = view.Pushable(scenario);
  ScenarioDiagram scene(scenario, view.Sink(scenario, {}));
  const Diagram diagram = scene.builder.Build();
  Simulator sim(diagram);
  view.Begin({.run = {.name = "run", .title = "Run"},
              .scenario = scenario,
              .scene = &scene,
              .diagram = &diagram});
  Client client(view.url());
  const auto before_tick = view.BeforeTick();
  const RunReport report;
  const auto tick = [&](int times) {
    for (int k = 0; k < times; ++k) {
      before_tick(sim, report);
      sim.AdvanceThroughTick();
    }
  };
  tick(10);
  client.Say(SetOf("control.pose.weight", 5e3));
  Json told;
  do told = client.Text();
  while (told["op"] != "parameterValues");
  const long before = Allocations();
  tick(200);
  EXPECT_EQ(Allocations() - before, 0);
  view.End("it is over");
}

TEST(LiveView, ShowsOneRunOnly) {
  LiveView view({.port = 0});
  const TemporaryDirectory out;
  EXPECT_EQ(ErrorOf([&] {
              RunExperiment(ExperimentFile::ReadText(kHolding, "holding.yaml", {{"repeat", "2"}}),
                            {.out = out.path(), .view = &view});
            }),
            "a page shows one run; name it with --run, and --repeat 1, got 2");
}

}  // namespace
}  // namespace pliant
