// What a tick costs while others look on: the compliance controller of Celerier et al. 2025 (EC) on
// a simulated Gen3 at 1 kHz, as it is, shown to nobody, and shown to twenty clients that are slow,
// dead or malicious.
//
//   live_bench --benchmark_format=console
//
// A tick is measured with the changes that clients ask for before it; how late it begins, against a
// sleep to its time. The clients are threads of this program: on two processors they take time from
// the tick as any program does.

#include <benchmark/benchmark.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "pliant/analysis/live_view.h"
#include "pliant/systems/real_time_runner.h"
#include "pliant/tests/support/web_client.h"

namespace pliant {
namespace {

constexpr double kSeconds = 4;
constexpr const char* kHolding = R"(
title: Holding
summary: An arm holds its pose.
robot: gen3
station: !SimulatedArm {engine: recursive}
controller: !Compliance {tool: tool_frame, posture: {compliance: 1}}
integrator: {method: bogacki_shampine}
duration_s: 1000
)";

const std::string kEverything = [] {
  std::string all = R"({"op":"subscribe","subscriptions":[)";
  for (int id = 1; id <= 60; ++id)
    all += (id > 1 ? "," : "") + ("{\"id\":" + std::to_string(id)) +
           ",\"channelId\":" + std::to_string(id) + "}";
  return all + "]}";
}();

/// Five each of: who subscribes to everything and reads nothing; who never ends a request; who
/// sends nonsense without pause; who sets parameters without pause.
class BadClients {
 public:
  explicit BadClients(std::uint16_t port) {
    for (int k = 0; k < 5; ++k) {
      auto& dead = Add(port);
      dead.Upgrade(dead.Host());
      dead.SendFrame(kEverything);
      Add(port).Send("GET / HT");
      Flood(port, std::string(2000, '['));
      Flood(port, R"({"op":"setParameters","parameters":[{"name":"control.pose.weight",)"
                  R"("value":10000}]})");
    }
  }
  ~BadClients() { stop_ = true; }
  BadClients(const BadClients&) = delete;
  BadClients& operator=(const BadClients&) = delete;

 private:
  WebClient& Add(std::uint16_t port) {
    return *clients_.emplace_back(std::make_unique<WebClient>(port));
  }
  void Flood(std::uint16_t port, std::string frame) {
    threads_.emplace_back([this, port, frame = std::move(frame)] {
      while (!stop_) try {
          WebClient client(port);
          client.Upgrade(client.Host());
          while (!stop_) {
            client.SendFrame(frame);
            std::this_thread::sleep_for(std::chrono::microseconds(500));
          }
        } catch (const std::runtime_error&) {
          std::this_thread::sleep_for(std::chrono::milliseconds(10));  // thrown out
        }
    });
  }

  std::atomic<bool> stop_{false};
  std::vector<std::unique_ptr<WebClient>> clients_;
  std::vector<std::jthread> threads_;
};

void Tell(benchmark::State& state, const RunReport& report) {
  state.counters["median_us"] = 1e6 * report.compute.Quantile(0.5);
  state.counters["p99_us"] = 1e6 * report.compute.Quantile(0.99);
  state.counters["p999_us"] = 1e6 * report.compute.Quantile(0.999);
  state.counters["worst_us"] = 1e6 * report.compute.worst();
  state.counters["late_median_us"] = 1e6 * report.lateness.Quantile(0.5);
  state.counters["late_p99_us"] = 1e6 * report.lateness.Quantile(0.99);
  state.counters["late_worst_us"] = 1e6 * report.lateness.worst();
  state.counters["missed"] = static_cast<double>(report.missed);
}

/// `clients`: −1 without a view.
void PacedTick(benchmark::State& state, int clients) {
  Scenario scenario = ExperimentFile::ReadText(kHolding, "holding.yaml").scenarios.front();
  for (auto _ : state) {
    std::unique_ptr<LiveView> view;
    if (clients >= 0)
      view = std::make_unique<LiveView>(LiveView::Options{.port = 0, .control = true});
    ScenarioDiagram scene(scenario, view ? view->Sink(scenario, {}) : nullptr);
    const Diagram diagram = scene.builder.Build();
    Simulator sim(diagram, {.integrator = scenario.integrator});
    RealTimeRunner::Options options;
    std::unique_ptr<BadClients> bad;
    if (view) {
      options.before_tick = view->BeforeTick();
      view->Begin({.run = {.name = "run", .title = "Run"},
                   .scenario = scenario,
                   .scene = &scene,
                   .diagram = &diagram});
      const std::string url = view->url();
      const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
      if (clients > 0) bad = std::make_unique<BadClients>(port);
    }
    RealTimeRunner runner(sim, options);
    Tell(state, runner.Run(kSeconds));
    if (view) view->End("the benchmark is over");
  }
}

BENCHMARK_CAPTURE(PacedTick, without_a_view, -1)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(PacedTick, nobody_looks, 0)->Iterations(1)->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(PacedTick, twenty_bad_clients, 20)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace pliant

BENCHMARK_MAIN();
