#include "pliant/analysis/live_history.h"

#include <algorithm>

#include "pliant/analysis/cdr.h"

namespace pliant::internal {

namespace {

constexpr std::int64_t kBetweenRows = 10'000'000;  // [ns]
constexpr double kTail = 10 + 1e-6;                // [s]
constexpr std::size_t kMostRows = 20'000;

}  // namespace

void LiveHistory::Add(std::int64_t time_ns, std::span<const double> numbers) {
  if (last_ns_ && time_ns < *last_ns_ + kBetweenRows) return;
  last_ns_ = time_ns;
  std::vector<double> row{1e-9 * static_cast<double>(time_ns)};
  row.insert(row.end(), numbers.begin(), numbers.end());
  for (std::size_t c = 0; c < columns_.size(); ++c) columns_[c].push_back(row[c]);
  if (columns_.front().size() >= kMostRows) columns_ = Decimate(columns_, kMostRows / 2).columns;
  while (!tail_.empty() && tail_.front().front() < row.front() - kTail) tail_.pop_front();
  tail_.push_back(std::move(row));
  fresh_ = std::min(fresh_ + 1, tail_.size());
}

std::string LiveHistory::Fresh() {
  const std::size_t first = tail_.size() - fresh_;
  fresh_ = 0;
  return first < tail_.size() ? Message(first) : "";
}

std::string LiveHistory::Tail() const { return tail_.empty() ? "" : Message(0); }

std::string LiveHistory::Message(std::size_t first) const {
  std::vector<double> numbers;
  numbers.reserve((tail_.size() - first) * columns_.size());
  for (std::size_t r = first; r < tail_.size(); ++r)
    numbers.insert(numbers.end(), tail_[r].begin(), tail_[r].end());
  return (Cdr() << std::span<const double>(numbers)).bytes();
}

}  // namespace pliant::internal
