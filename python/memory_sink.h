#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include "pliant/analysis/recording.h"

namespace pliant::python {

/// Keeps what recorders record, in the order in which it comes.
class MemorySink final : public RecordSink {
 public:
  int Open(std::vector<RecordedValue> values) override {
    std::size_t width = 0;
    for (const RecordedValue& value : values) width += value.elements.size();
    streams_.push_back({std::move(values), width});
    return static_cast<int>(streams_.size()) - 1;
  }
  /// A row of the same time as the last one of its stream takes its place.
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override {
    const std::size_t at = cells_.size(), width = streams_[static_cast<std::size_t>(stream)].width;
    for (auto row = rows_.rbegin(); row != rows_.rend() && row->time_ns == time_ns; ++row)
      if (row->stream == stream) return {cells_.data() + row->at, width};
    try {
      cells_.resize(at + width);
      rows_.push_back({stream, time_ns, at});
    } catch (const std::bad_alloc&) {
      cells_.resize(at);
      full_ = true;
      return {};
    }
    return {cells_.data() + at, width};
  }
  void Commit() noexcept override {}

  /// A copy of all rows.
  Recording recording() const {
    RequireRoom();
    std::vector<RecordedSignal> signals;
    for (std::size_t s = 0; s < streams_.size(); ++s) {
      std::vector<const Row*> rows;
      for (const Row& row : rows_)
        if (row.stream == static_cast<int>(s)) rows.push_back(&row);
      std::size_t first = 0;
      for (const RecordedValue& value : streams_[s].values) {
        const auto elements = static_cast<Eigen::Index>(value.elements.size());
        const auto count = static_cast<Eigen::Index>(rows.size());
        RecordedSignal signal{value, Eigen::VectorXd(count), Eigen::MatrixXd(elements, count)};
        for (Eigen::Index k = 0; k < count; ++k) {
          const Row& row = *rows[static_cast<std::size_t>(k)];
          signal.times(k) = static_cast<double>(row.time_ns) / 1e9;
          signal.numbers.col(k) = Eigen::VectorXd::Map(cells_.data() + row.at + first, elements);
        }
        first += value.elements.size();
        signals.push_back(std::move(signal));
      }
    }
    return {std::move(signals), {}};
  }

  /// Hands all rows to another sink.
  void CopyTo(RecordSink& to) const {
    RequireRoom();
    std::vector<int> streams;
    for (const Stream& stream : streams_) streams.push_back(to.Open(stream.values));
    for (const Row& row : rows_) {
      const auto stream = static_cast<std::size_t>(row.stream);
      const std::span<double> room = to.Begin(streams[stream], row.time_ns);
      if (room.empty()) continue;
      std::copy_n(cells_.data() + row.at, room.size(), room.begin());
      to.Commit();
    }
  }

 private:
  struct Stream {
    std::vector<RecordedValue> values;
    std::size_t width;
  };
  struct Row {
    int stream;
    std::int64_t time_ns;
    std::size_t at;
  };

  void RequireRoom() const {
    Require(!full_,
            "the log did not fit into the memory; give log_period a larger value, or let "
            "pliant.run write it to a file");
  }

  std::vector<Stream> streams_;
  std::vector<Row> rows_;
  std::vector<double> cells_;
  bool full_ = false;
};

}  // namespace pliant::python
