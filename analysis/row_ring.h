#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>

namespace pliant::internal {

/// Rows of numbers on their way from one thread to one other, in a ring of fixed size. A row lies
/// in one piece, so that it is filled where it will be read. Neither side allocates, waits or
/// throws.
class RowRing {
 public:
  struct Row {
    int stream = 0;
    std::int64_t time_ns = 0;
    std::int64_t dropped = 0;  ///< rows before this one that found no room
    std::span<const double> numbers = {};
  };

  /// A row of so many numbers finds room in an empty ring of so many cells, wherever that begins.
  static constexpr std::size_t CellsFor(std::size_t numbers) { return 2 * (kHead + numbers); }

  explicit RowRing(std::size_t cells) : cells_{cells}, ring_{std::make_unique<double[]>(cells)} {}

  // What follows is for the thread that writes.

  /// Room for the numbers of a row; empty if there is none.
  std::span<double> Begin(int stream, std::int64_t time_ns, std::int64_t dropped,
                          std::size_t numbers) {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    const std::size_t size = kHead + numbers;
    const std::size_t to_end = cells_ - head % cells_;
    const std::size_t skipped = size <= to_end ? 0 : to_end;
    if (head + skipped + size - tail_seen_ > cells_) {
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head + skipped + size - tail_seen_ > cells_) return {};
    }
    if (skipped > 0) std::memcpy(At(head), &kSkip, sizeof kSkip);
    const Head row{static_cast<std::uint32_t>(size), stream, time_ns, dropped};
    std::memcpy(At(head + skipped), &row, sizeof row);
    next_head_ = head + skipped + size;
    return {At(head + skipped) + kHead, numbers};
  }

  /// Hands on what Begin has given room for.
  void Commit() { head_.store(next_head_, std::memory_order_release); }

  // What follows is for the thread that reads.

  /// The oldest row; valid until it is removed.
  std::optional<Row> Front() {
    std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_seen_) {
      head_seen_ = head_.load(std::memory_order_acquire);
      if (tail == head_seen_) return std::nullopt;
    }
    std::uint32_t size;
    std::memcpy(&size, At(tail), sizeof size);
    if (size == kSkip) tail += cells_ - tail % cells_;
    Head row;
    std::memcpy(&row, At(tail), sizeof row);
    next_tail_ = tail + row.size;
    return Row{row.stream, row.time_ns, row.dropped, {At(tail) + kHead, row.size - kHead}};
  }

  /// Removes what Front has shown.
  void Pop() { tail_.store(next_tail_, std::memory_order_release); }

 private:
  struct Head {
    std::uint32_t size;  // cells, this head included
    std::int32_t stream;
    std::int64_t time_ns;
    std::int64_t dropped;
  };
  static constexpr std::size_t kHead = sizeof(Head) / sizeof(double);
  // In place of a size: the next row begins the ring anew.
  static constexpr std::uint32_t kSkip = 0;
  static constexpr std::size_t kCacheLine = 64;

  double* At(std::uint64_t cell) const { return ring_.get() + cell % cells_; }

  const std::size_t cells_;
  const std::unique_ptr<double[]> ring_;

  // Cells ever written and ever read. Each side keeps what it has last seen of the other on a cache
  // line of its own.
  alignas(kCacheLine) std::atomic<std::uint64_t> head_{0};
  std::uint64_t next_head_ = 0;
  std::uint64_t tail_seen_ = 0;
  alignas(kCacheLine) std::atomic<std::uint64_t> tail_{0};
  std::uint64_t next_tail_ = 0;
  std::uint64_t head_seen_ = 0;
};

}  // namespace pliant::internal
