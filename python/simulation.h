#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pliant/analysis/experiment.h"
#include "pliant/analysis/linearize.h"
#include "pliant/analysis/memory_sink.h"
#include "pliant/analysis/readable_values.h"
#include "pliant/diagrams/law_diagram.h"
#include "pliant/systems/simulator.h"

namespace pliant::python {

/// A name that nothing has; what is thrown becomes a KeyError.
class UnknownName : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Wrong use that no scenario is to blame for; becomes a RuntimeError.
class WrongUse : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// One run of a scenario, in memory, that is advanced by hand.
class Simulation {
 public:
  Simulation(const ExperimentFile& file, std::size_t run, TorqueLaw::Function law);

  /// Advances until t is reached, the run has ended, somebody has asked to stop, or `at_most` of
  /// wall time is over; true unless it is the last of these.
  bool AdvanceFor(double t, std::chrono::milliseconds at_most);
  /// The tick at the end of the scenario's duration, if there is one.
  void TickAtEnd();

  double time() const { return time_; }
  double duration() const { return scenario_.duration_s; }
  std::string ended() const;
  const Scenario& scenario() const { return scenario_; }
  const std::vector<ReadableValue>& ports() const { return ports_; }
  const ReadableValue& port(const std::string& path) const;

  std::vector<double> Get(const ReadableValue& port);
  void Set(const ReadableValue& port, const std::vector<double>& numbers);

  Recording log() const { return sink_->recording(); }
  void WriteLog(const std::filesystem::path& file, bool force) const;
  Linearization LinearizeBetween(const std::vector<std::string>& inputs,
                                 const std::vector<std::string>& outputs);

  std::atomic<bool> stop{false};

 private:
  Diagram Build(TorqueLaw::Function law);
  Values ValuesOf(const std::vector<std::string>& paths) const;

  const std::string experiment_;
  const RunOf run_;
  const Scenario scenario_;
  const bool has_law_;
  const std::shared_ptr<MemorySink> sink_ = std::make_shared<MemorySink>();
  Duration period_;
  Diagram diagram_;
  Simulator sim_;
  std::vector<ReadableValue> ports_;
  std::vector<std::pair<std::string, int>> changed_;  // paths, and their streams in the sink
  std::atomic<double> time_{0};
  double wall_s_ = 0;
};

/// The model of an arm that comes with pliant.
RobotModel ModelNamed(const std::string& robot);

}  // namespace pliant::python
