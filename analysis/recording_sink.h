#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pliant/analysis/recording.h"
#include "pliant/systems/record_sink.h"

namespace pliant {

/// Keeps the rows of some signals in memory, as a log of the same run has them:
///
///   const auto sink = std::make_shared<RecordingSink>(std::vector<std::string>{"arm.velocity"},
///   1001); … sink->recording()["arm.velocity"].numbers
///
/// For one recorder.
class RecordingSink final : public RecordSink {
 public:
  /// The signals to keep, and how many rows to make room for.
  RecordingSink(std::vector<std::string> paths, Eigen::Index most_rows)
      : paths_{std::move(paths)}, most_rows_{most_rows} {}

  int Open(std::vector<RecordedValue> values) override {
    kept_.clear();
    rows_ = 0;
    std::size_t at = 0;
    for (RecordedValue& value : values) {
      const std::size_t size = value.elements.size();
      if (std::ranges::find(paths_, value.path) != paths_.end()) {
        const Eigen::MatrixXd room(size, most_rows_);
        kept_.push_back({at, {std::move(value), Eigen::VectorXd(most_rows_), room}});
      }
      at += size;
    }
    row_.resize(at);
    return 0;
  }

  std::span<double> Begin(int, std::int64_t time_ns) noexcept override {
    if (rows_ == most_rows_) {
      dropped_ = true;
      return {};
    }
    time_ns_ = time_ns;
    return row_;
  }

  void Commit() noexcept override {
    for (Kept& kept : kept_) {
      // As a reader of a log divides.
      kept.signal.times(rows_) = static_cast<double>(time_ns_) / 1e9;
      kept.signal.numbers.col(rows_) =
          Eigen::VectorXd::Map(row_.data() + kept.at, kept.signal.numbers.rows());
    }
    ++rows_;
  }

  /// Throws Error if there were more rows than there was room for.
  Recording recording() const {
    Require(!dropped_, "there must be room for all rows", most_rows_);
    std::vector<RecordedSignal> signals;
    for (const Kept& kept : kept_)
      signals.push_back(
          {kept.signal, kept.signal.times.head(rows_), kept.signal.numbers.leftCols(rows_)});
    return {std::move(signals), {}};
  }

 private:
  struct Kept {
    std::size_t at;  // of its first number in a row
    RecordedSignal signal;
  };

  const std::vector<std::string> paths_;
  const Eigen::Index most_rows_;
  std::vector<Kept> kept_;
  std::vector<double> row_;
  Eigen::Index rows_ = 0;
  std::int64_t time_ns_ = 0;
  bool dropped_ = false;
};

}  // namespace pliant
