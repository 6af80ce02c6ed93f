#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/analysis/page_data.h"

namespace pliant::internal {

/// Rows of a run that goes on, as a page shows them: at most one in 10 ms. All of the run is kept,
/// in at most 20 000 rows: when they are full, Decimate halves them.
class LiveHistory {
 public:
  /// Of rows with so many numbers.
  explicit LiveHistory(std::size_t numbers) : columns_(numbers + 1) {}

  void Add(std::int64_t time_ns, std::span<const double> numbers);

  bool empty() const { return columns_.front().empty(); }
  /// The time [s] and the numbers since the start.
  const PageColumns& columns() const { return columns_; }

  /// Messages of the type pliant/msg/Rows, in CDR: row after row the time and the numbers. Fresh
  /// has the rows since the last call, empty if there are none; Tail those of the last 10 s.
  std::string Fresh();
  std::string Tail() const;

 private:
  std::string Message(std::size_t first) const;

  PageColumns columns_;
  std::optional<std::int64_t> last_ns_;
  std::deque<std::vector<double>> tail_;
  std::size_t fresh_ = 0;  // of the tail's rows, how many were not asked for yet
};

}  // namespace pliant::internal
