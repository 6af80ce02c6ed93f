#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pliant/analysis/recording.h"
#include "pliant/systems/diagram.h"
#include "pliant/systems/logger.h"
#include "pliant/systems/simulator.h"

namespace pliant {

/// What a Logger has logged, as a log file gives it back.
inline Recording RecordingOf(const Diagram& diagram, const Log& log) {
  std::vector<RecordedSignal> signals;
  const std::vector<ValueInfo> values = diagram.Values();
  for (const std::string& column : log.columns()) {
    // "path[element] (unit)" or "path.field (unit)"; the path is the longest that fits
    const std::string name = column.substr(0, column.find(" ("));
    const std::string unit =
        name == column ? "" : column.substr(name.size() + 2, column.size() - name.size() - 3);
    const ValueInfo* value = nullptr;
    for (const ValueInfo& v : values)
      if (name.starts_with(v.path) && (!value || v.path.size() > value->path.size())) value = &v;
    if (signals.empty() || signals.back().path != value->path) {
      signals.push_back({});
      signals.back().path = value->path;
      signals.back().type = value->type;
      signals.back().times = log.times();
      signals.back().numbers.resize(0, log.times().size());
    }
    RecordedSignal& signal = signals.back();
    signal.elements.push_back(name.substr(value->path.size()));
    signal.units.push_back(unit);
    signal.numbers.conservativeResize(signal.numbers.rows() + 1, Eigen::NoChange);
    signal.numbers.bottomRows<1>() = log[column].transpose();
  }
  return Recording(std::move(signals), {});
}

/// A diagram that is not built yet, and a logger in it.
struct LoggedDiagram {
  DiagramBuilder builder;
  const Logger* logger;
};

/// What its logger sees until the tick at `end` [s], through which it runs.
inline Recording RecordingOf(LoggedDiagram whole, double end) {
  const Diagram diagram = whole.builder.Build();
  Simulator sim{diagram};
  sim.AdvanceTo(end + 1e-9);
  return RecordingOf(diagram, sim.Get(whole.logger->log));
}

}  // namespace pliant
