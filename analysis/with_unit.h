#pragma once

#include <string>
#include <string_view>

namespace pliant {

/// A number as a person writes it: three significant digits, never fewer digits than stand before
/// the point, and for m, s, rad, N, N·m, W, J, V, A and Hz, alone or per something, the prefix that
/// suits it.
///
///   WithUnit(0.00123, "m")    "1.23 mm"       WithUnit(12345, "N")     "12.3 kN"
///   WithUnit(4.2e-5, "m/s")   "42.0 µm/s"     WithUnit(0.00123, "m²")  "0.00123 m²"
std::string WithUnit(double value, std::string_view unit);

/// The unit in which WithUnit writes a number, such as "mm", and how many of `unit` it is, 1e-3.
struct ScaledUnit {
  double factor;
  std::string unit;
};
ScaledUnit UnitFor(double value, std::string_view unit);

}  // namespace pliant
