#include "pliant/analysis/with_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace pliant {

namespace {

std::string Printed(const char* format, int decimals, double value) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), format, decimals, value);
  return text.data();
}

/// To three significant digits, so that 999.6 µm becomes 1.00 mm.
double Rounded(double value) { return std::stod(Printed("%.*e", 2, value)); }

std::string ThreeDigits(double value) {
  if (value == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(Rounded(value)))));
  if (exponent < -3 || exponent > 6) return Printed("%.*e", 2, value);
  return Printed("%.*f", std::max(0, 2 - exponent), value);
}

struct Prefix {
  double factor;
  const char* text;
};
constexpr std::array<Prefix, 3> kSmall{{{1e-3, "m"}, {1e-6, "µ"}, {1e-9, "n"}}};
constexpr std::array<Prefix, 2> kLarge{{{1e6, "M"}, {1e3, "k"}}};

bool BeginsWith(std::string_view unit, std::string_view symbol) {
  if (!unit.starts_with(symbol)) return false;
  const std::string_view rest = unit.substr(symbol.size());
  return rest.empty() || rest.starts_with("/") || rest.starts_with("·");
}

bool BeginsWithOneOf(std::string_view unit, std::initializer_list<std::string_view> symbols) {
  return std::ranges::any_of(symbols, [&](std::string_view s) { return BeginsWith(unit, s); });
}

Prefix PrefixOf(double value, std::string_view unit) {
  const double size = std::abs(Rounded(value));
  if (size > 0 && size < 1 &&
      BeginsWithOneOf(unit, {"m", "s", "rad", "N", "W", "J", "V", "A", "Hz"})) {
    const auto fits = [&](const Prefix& p) { return size >= p.factor * (1 - 1e-9); };
    const auto prefix = std::ranges::find_if(kSmall, fits);
    if (prefix != kSmall.end()) return *prefix;
  }
  if (BeginsWithOneOf(unit, {"N", "W", "J", "Hz"})) {
    const auto fits = [&](const Prefix& p) { return size >= p.factor; };
    const auto prefix = std::ranges::find_if(kLarge, fits);
    if (prefix != kLarge.end()) return *prefix;
  }
  return {1, ""};
}

}  // namespace

ScaledUnit UnitFor(double value, std::string_view unit) {
  if (!std::isfinite(value)) return {1, std::string(unit)};
  const Prefix prefix = PrefixOf(value, unit);
  return {prefix.factor, prefix.text + std::string(unit)};
}

std::string WithUnit(double value, std::string_view unit) {
  if (std::isnan(value)) return "not a number";
  const Prefix prefix = PrefixOf(value, unit);
  const std::string number =
      std::isinf(value) ? (value > 0 ? "∞" : "-∞") : ThreeDigits(value / prefix.factor);
  return unit.empty() ? number : number + " " + prefix.text + std::string(unit);
}

}  // namespace pliant
