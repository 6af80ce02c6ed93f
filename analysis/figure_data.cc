#include "pliant/analysis/figure_data.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>

namespace pliant::internal {

namespace {

bool IsDrawn(std::span<const double> x, std::span<const double> y, std::size_t i) {
  return IsDrawable(x[i]) && IsDrawable(y[i]);
}

/// Of the points [begin, end) appends the first of a gap, the first drawn and the extremes.
void ThinOut(std::span<const double> x, std::span<const double> y, std::size_t begin,
             std::size_t end, std::vector<std::size_t>& kept) {
  std::vector<std::size_t> drawn, chosen;
  for (std::size_t i = begin; i < end; ++i) {
    if (IsDrawn(x, y, i)) {
      drawn.push_back(i);
    } else if (chosen.empty()) {
      chosen.push_back(i);
    }
  }
  if (!drawn.empty()) {
    const auto by_x = std::ranges::minmax_element(drawn, {}, [&](std::size_t i) { return x[i]; });
    const auto by_y = std::ranges::minmax_element(drawn, {}, [&](std::size_t i) { return y[i]; });
    chosen.insert(chosen.end(), {drawn.front(), *by_x.min, *by_x.max, *by_y.min, *by_y.max});
  }
  std::ranges::sort(chosen);
  kept.insert(kept.end(), chosen.begin(), std::ranges::unique(chosen).begin());
}

void Append(std::string& text, double value) {
  std::array<char, 32> digits;
  text.append(digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr);
}

}  // namespace

bool IsDrawable(double value) { return std::abs(value) < 1e100; }

std::vector<std::size_t> Thinned(std::span<const double> x, std::span<const double> y) {
  std::vector<std::size_t> kept(x.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  // A smooth curve has its extremes at the ends of most stretches, so shorter ones will do.
  for (std::size_t stretches = kMostPoints; kept.size() > kMostPoints; stretches -= stretches / 4) {
    kept.clear();
    for (std::size_t s = 0; s < stretches; ++s)
      ThinOut(x, y, x.size() * s / stretches, x.size() * (s + 1) / stretches, kept);
    if (kept.back() + 1 < x.size()) kept.push_back(x.size() - 1);
  }
  return kept;
}

std::string DataOf(const Curve& curve) {
  std::string data;
  bool gap = false;
  for (const std::size_t i : Thinned(curve.x, curve.y)) {
    if (!IsDrawn(curve.x, curve.y, i)) {
      gap = !data.empty();
      continue;
    }
    if (gap) data += '\n';
    gap = false;
    Append(data, curve.x[i]);
    data += ' ';
    Append(data, curve.y[i]);
    data += '\n';
  }
  return data;
}

}  // namespace pliant::internal
