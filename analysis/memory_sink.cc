#include "pliant/analysis/memory_sink.h"

#include <algorithm>
#include <new>
#include <utility>

#include "pliant/systems/error.h"

namespace pliant {

int MemorySink::Open(std::vector<RecordedValue> values) {
  Stream stream;
  std::size_t at = 0;
  for (RecordedValue& value : values) {
    const std::size_t end = at + value.elements.size();
    if (paths_.empty() || std::ranges::find(paths_, value.path) != paths_.end()) {
      for (std::size_t i = at; i < end; ++i) stream.kept.push_back(i);
      stream.values.push_back(std::move(value));
    }
    at = end;
  }
  stream.row.resize(at);
  streams_.push_back(std::move(stream));
  return static_cast<int>(streams_.size()) - 1;
}

std::span<double> MemorySink::Begin(int stream, std::int64_t time_ns) noexcept {
  stream_ = static_cast<std::size_t>(stream);
  time_ns_ = time_ns;
  return streams_[stream_].row;
}

void MemorySink::Commit() noexcept {
  const Stream& stream = streams_[stream_];
  try {
    const std::size_t at = CellsOfRow();
    std::ranges::transform(stream.kept, cells_.data() + at,
                           [&](std::size_t i) { return stream.row[i]; });
  } catch (const std::bad_alloc&) {
    full_ = true;
  }
}

/// Where the cells of the row begin that was filled.
std::size_t MemorySink::CellsOfRow() {
  for (auto row = rows_.rbegin(); row != rows_.rend() && row->time_ns == time_ns_; ++row)
    if (row->stream == stream_) return row->at;
  const std::size_t at = cells_.size();
  cells_.resize(at + streams_[stream_].kept.size());
  rows_.push_back({stream_, time_ns_, at});
  return at;
}

Recording MemorySink::recording() const {
  RequireRoom();
  std::vector<RecordedSignal> signals;
  for (std::size_t s = 0; s < streams_.size(); ++s) {
    std::vector<const Row*> rows;
    for (const Row& row : rows_)
      if (row.stream == s) rows.push_back(&row);
    std::size_t first = 0;
    for (const RecordedValue& value : streams_[s].values) {
      const auto elements = static_cast<Eigen::Index>(value.elements.size());
      const auto count = static_cast<Eigen::Index>(rows.size());
      RecordedSignal signal{value, Eigen::VectorXd(count), Eigen::MatrixXd(elements, count)};
      for (Eigen::Index k = 0; k < count; ++k) {
        const Row& row = *rows[static_cast<std::size_t>(k)];
        signal.times(k) = static_cast<double>(row.time_ns) / 1e9;  // as a reader of a log divides
        signal.numbers.col(k) = Eigen::VectorXd::Map(cells_.data() + row.at + first, elements);
      }
      first += value.elements.size();
      signals.push_back(std::move(signal));
    }
  }
  return {std::move(signals), {}};
}

void MemorySink::CopyTo(RecordSink& to) const {
  RequireRoom();
  std::vector<int> streams;
  for (const Stream& stream : streams_) streams.push_back(to.Open(stream.values));
  for (const Row& row : rows_) {
    const std::span<double> room = to.Begin(streams[row.stream], row.time_ns);
    if (room.empty()) continue;
    std::copy_n(cells_.data() + row.at, room.size(), room.begin());
    to.Commit();
  }
}

void MemorySink::RequireRoom() const {
  Require(!full_,
          "what was recorded did not fit into the memory; give log_period a larger value, or let "
          "`pliant run` write it to a file");
}

}  // namespace pliant
