#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/analysis/recording.h"
#include "pliant/systems/record_sink.h"

namespace pliant {

/// Keeps rows in memory, as a log of the same run has them, in the order in which they come:
///
///   const auto sink = std::make_shared<MemorySink>(std::vector<std::string>{"arm.velocity"});
///   … sink->recording()["arm.velocity"].numbers
///
/// Not for real time: it allocates.
class MemorySink final : public RecordSink {
 public:
  /// The signals to keep; all, if none is named.
  explicit MemorySink(std::vector<std::string> paths = {}) : paths_{std::move(paths)} {}

  int Open(std::vector<RecordedValue> values) override;
  std::span<double> Begin(int stream, std::int64_t time_ns) noexcept override;
  /// A row of the same time as the last one of its stream takes its place.
  void Commit() noexcept override;

  /// Whether a row did not fit into the memory.
  bool is_full() const { return full_; }
  /// A copy of all rows. Throws Error if they did not fit into the memory.
  Recording recording() const;
  /// Hands all rows to another sink. Throws Error as recording() does.
  void CopyTo(RecordSink& to) const;

 private:
  struct Stream {
    std::vector<RecordedValue> values = {};
    std::vector<std::size_t> kept = {};  // places in the row of what is kept
    std::vector<double> row = {};        // of all values
  };
  struct Row {
    std::size_t stream;
    std::int64_t time_ns;
    std::size_t at;
  };

  void RequireRoom() const;
  std::size_t CellsOfRow();

  const std::vector<std::string> paths_;
  std::vector<Stream> streams_;
  std::vector<Row> rows_;
  std::vector<double> cells_;
  std::size_t stream_ = 0;
  std::int64_t time_ns_ = 0;
  bool full_ = false;
};

}  // namespace pliant
