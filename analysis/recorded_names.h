#pragma once

#include <utility>
#include <vector>

#include "pliant/analysis/recording.h"

namespace pliant {

/// Takes the names of what would be recorded, and nothing else.
class RecordedNames final : public RecordSink {
 public:
  int Open(std::vector<RecordedValue> values) override {
    for (RecordedValue& value : values) {
      const Eigen::MatrixXd none(value.elements.size(), 0);
      signals.push_back({std::move(value), {}, none});
    }
    return 0;
  }
  std::span<double> Begin(int, std::int64_t) noexcept override { return {}; }
  void Commit() noexcept override {}

  std::vector<RecordedSignal> signals;
};

}  // namespace pliant
