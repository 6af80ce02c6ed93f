#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace pliant {

/// Random numbers as a function of what they are for, so that a run can be stopped, restored and
/// repeated bit for bit: the n-th number of a stream is the same whenever it is asked for.
///
/// Two different seeds give independent streams.
/// Source: the mixing function of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014), applied to a
/// counter.
class RandomStream {
 public:
  explicit constexpr RandomStream(std::uint64_t seed) : key_{Mix(seed + kStep)} {}

  /// A stream of its own for a part of what this one is for.
  constexpr RandomStream Part(std::uint64_t number) const {
    return RandomStream(key_ ^ Mix(number + kStep));
  }

  /// Uniform in (0, 1).
  constexpr double Uniform(std::uint64_t n) const {
    return (static_cast<double>(Mix(key_ + (n + 1) * kStep) >> 11) + 0.5) * 0x1p-53;
  }

  /// Normal, of mean 0 and standard deviation 1 (Box & Muller 1958).
  double Normal(std::uint64_t n) const {
    return std::sqrt(-2 * std::log(Uniform(2 * n))) *
           std::cos(2 * std::numbers::pi * Uniform(2 * n + 1));
  }

 private:
  static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;

  static constexpr std::uint64_t Mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::uint64_t key_;
};

/// k of the tick at t = ⌊k h⌋ ns.
inline std::uint64_t TickAt(double t, double h) {
  return static_cast<std::uint64_t>(std::llround(t / h));
}

}  // namespace pliant
