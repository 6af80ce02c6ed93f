#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant {

/// Counts spans of time [ns] in buckets of a fixed relative width: below 256 ns one for each
/// nanosecond, from there on 128 for each doubling, up to 2⁴⁰ ns = 18 min; the last one takes all
/// that is longer:
///
///   v = (128 + m) 2^e + r,   0 ≤ m < 128,   0 ≤ r < 2^e:   bucket 128 (e + 1) + m
///
/// All room is taken at the start; to count does not allocate.
class TimeHistogram {
 public:
  static constexpr double kRelativeWidth = 1.0 / 128;  ///< of a bucket, at most

  TimeHistogram() : buckets_(kBuckets, 0) {}

  /// What is below zero counts as zero.
  void Count(std::int64_t ns) noexcept {
    const std::int64_t v = std::max<std::int64_t>(ns, 0);
    ++buckets_[BucketOf(v)];
    ++count_;
    worst_ns_ = std::max(worst_ns_, v);
  }

  std::int64_t count() const { return count_; }
  double worst() const { return 1e-9 * static_cast<double>(worst_ns_); }  ///< [s], exact

  /// [s] Of N spans in order, the one with number ⌈q N⌉; 0 ≤ q ≤ 1. Never less than the exact one,
  /// and greater by less than a bucket. 0 of no spans.
  double Quantile(double q) const;

  bool operator==(const TimeHistogram&) const = default;

 private:
  static constexpr int kBits = 7, kLongest = 40;
  static constexpr std::size_t kBuckets = std::size_t{kLongest - kBits + 1} << kBits;

  static std::size_t BucketOf(std::int64_t ns) noexcept {
    const auto v = static_cast<std::uint64_t>(ns);
    const int shift = std::max(0, static_cast<int>(std::bit_width(v)) - kBits - 1);
    return std::min<std::size_t>((static_cast<std::size_t>(shift) << kBits) + (v >> shift),
                                 kBuckets - 1);
  }
  static std::int64_t LongestOf(std::size_t bucket);

  std::vector<std::int64_t> buckets_;
  std::int64_t count_ = 0, worst_ns_ = 0;
};

}  // namespace pliant
