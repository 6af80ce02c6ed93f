#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace pliant {

/// A span of time [s] for a person, of three digits: "850 ns", "21.3 µs", "1 ms", "12 s".
inline std::string TimeText(double seconds) {
  struct Unit {
    double seconds;
    const char* name;
  };
  constexpr std::array<Unit, 4> kUnits{{{1e-9, "ns"}, {1e-6, "µs"}, {1e-3, "ms"}, {1, "s"}}};
  std::size_t u = 0;
  while (u + 1 < kUnits.size() && std::abs(seconds) >= 999.5 * kUnits[u].seconds) ++u;
  std::array<char, 40> text;
  const double number = seconds / kUnits[u].seconds;
  std::snprintf(text.data(), text.size(), std::abs(number) < 999.5 ? "%.3g %s" : "%.0f %s", number,
                kUnits[u].name);
  return text.data();
}

}  // namespace pliant
