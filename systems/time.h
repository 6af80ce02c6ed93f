#pragma once

#include <chrono>
#include <cstdint>
#include <numeric>
#include <string>

#include "pliant/systems/error.h"

namespace pliant {

using namespace std::chrono_literals;

/// A span of time as an exact rational number of nanoseconds, so that a rate such as 30 Hz does not
/// drift. Written as a std::chrono value (`1ms`) or as `Hertz(30)`.
class Duration {
 public:
  constexpr Duration() = default;

  template <class Rep, class Ratio>
  requires std::integral<Rep>
  constexpr Duration(std::chrono::duration<Rep, Ratio> d)  // NOLINT: 1ms is a Duration
      : numerator_{std::chrono::nanoseconds(d).count()} {}

  static constexpr Duration Nanoseconds(std::int64_t numerator, std::int64_t denominator = 1) {
    if (denominator <= 0) throw Error("a rate must be > 0, got " + Text(denominator));
    const std::int64_t g = std::gcd(numerator, denominator);
    Duration d;
    d.numerator_ = numerator / g;
    d.denominator_ = denominator / g;
    return d;
  }

  /// ⌊k · this⌋ in whole nanoseconds: the time of tick k.
  constexpr std::int64_t Times(std::int64_t k) const {
    return static_cast<std::int64_t>(static_cast<__int128>(k) * numerator_ / denominator_);
  }

  constexpr double seconds() const {
    return static_cast<double>(numerator_) / (1e9 * static_cast<double>(denominator_));
  }

  constexpr bool operator==(const Duration&) const = default;
  constexpr bool operator<(const Duration& o) const {
    return static_cast<__int128>(numerator_) * o.denominator_ <
           static_cast<__int128>(o.numerator_) * denominator_;
  }

  constexpr Duration operator+(const Duration& o) const {
    return Nanoseconds(numerator_ * o.denominator_ + o.numerator_ * denominator_,
                       denominator_ * o.denominator_);
  }

  std::string text() const;  ///< such as "1 ms" or "30 Hz"

 private:
  std::int64_t numerator_ = 0;
  std::int64_t denominator_ = 1;
};

/// The period of a rate, exact for whole numbers and for ratios: `Hertz(30000, 1001)`.
constexpr Duration Hertz(std::int64_t per_second, std::int64_t seconds = 1) {
  return Duration::Nanoseconds(1'000'000'000 * seconds, per_second);
}

/// A period for what ticks once: longer than any run.
inline constexpr Duration kOnce = std::chrono::seconds(9'000'000'000);

constexpr double seconds(Duration d) { return d.seconds(); }

inline std::string Duration::text() const {
  if (denominator_ != 1) return Text(1e9 * static_cast<double>(denominator_) / numerator_) + " Hz";
  if (numerator_ % 1'000'000'000 == 0) return Text(numerator_ / 1'000'000'000) + " s";
  if (numerator_ % 1'000'000 == 0) return Text(numerator_ / 1'000'000) + " ms";
  if (numerator_ % 1'000 == 0) return Text(numerator_ / 1'000) + " us";
  return Text(numerator_) + " ns";
}

}  // namespace pliant
