#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/experiment.h"
#include "pliant/controllers/operator_panel.h"
#include "pliant/systems/real_time_runner.h"
#include "pliant/systems/record_sink.h"

namespace pliant {

/// Shows a run while it goes on: a page at a port of this machine, and on the same port the
/// Foxglove WebSocket protocol with the topics of the run's log and its tunable values as
/// parameters.
///
///   LiveView view({.port = 8765, .control = true});
///   ScenarioDiagram scene(view.Pushable(scenario), view.Sink(scenario, log), …);
///   const Diagram diagram = scene.builder.Build();
///   Simulator sim(diagram);
///   view.Begin({.run = run, .scenario = scenario, .scene = &scene, .diagram = &diagram});
///   RealTimeRunner runner(sim, {.stop = &view.stop(), .before_tick = view.BeforeTick()});
///   runner.Run(end);
///   view.End(…);
///
/// A thread of its own serves; the run's thread neither waits for it nor allocates. Rows that find
/// no room on the way are not shown. What is changed takes effect at the next tick and is recorded
/// by the log, at that tick, under the path of the input.
class LiveView {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    std::uint16_t port = 8765;  ///< 0: any that is free
    bool control = false;       ///< clients may set parameters, push and acknowledge
    std::vector<std::string> origins =
        {};  ///< of pages that may ask, beside its own and Foxglove's
  };
  struct Run {
    RunOf run;
    Scenario scenario;
    const ScenarioDiagram* scene = nullptr;
    const Diagram* diagram = nullptr;
    std::shared_ptr<OperatorPanel> panel = {};  ///< of an arm that is there
  };

  /// Listens. Throws Error if it cannot.
  explicit LiveView(const Options& o);
  ~LiveView();

  std::string url() const;

  /// The scenario with a !LivePush in its environment, if its arm is simulated.
  Scenario Pushable(Scenario scenario) const;
  /// What recorders give their rows to: it hands them to `log`, if there is one, and to clients.
  std::shared_ptr<RecordSink> Sink(const Scenario& scenario, std::shared_ptr<RecordSink> log);

  /// Serves from now on. `run` and what it points to must outlive End.
  void Begin(const Run& run);

  /// Somebody has asked to stop; of an arm that is there, the panel knows.
  const std::atomic<bool>& stop() const;
  void RequestStop();

  /// For the runner: makes the changes that clients have asked for, and shows how the run goes. It
  /// does not allocate.
  std::function<void(Simulator&, const RunReport&)> BeforeTick();

  /// Tells clients that the run has ended, and why, and serves no more.
  void End(const std::string& reason);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pliant
