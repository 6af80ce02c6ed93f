#include "pliant/analysis/swept_value.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string_view>

#include "pliant/analysis/printable.h"
#include "pliant/analysis/read_number.h"
#include "pliant/plants/parameter_text.h"

namespace pliant {

using internal::ReadNumber;

namespace {

constexpr std::size_t kMostValues = 10'000;

/// At commas that stand in no brackets and no quotes.
std::vector<std::string> Split(std::string_view text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    }
    if (c == ',' && depth == 0 && !quote)
      parts.emplace_back();
    else if (c != ' ' || !parts.back().empty())
      parts.back() += c;
  }
  return parts;
}

std::vector<std::string> SplitAt(const std::string& text, char sign) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == sign)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

/// Rounded to 15 digits: 0.3, where a sum of tenths is 0.30000000000000004.
std::string Rounded(double value) {
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), "%.15g", value);
  return internal::YamlText(*ReadNumber(text.data()));
}

}  // namespace

bool LiesIn(const std::string& path, const std::string& other) {
  // An index may have zeros before it.
  const auto plain = [](const std::string& p) {
    std::string all;
    for (std::string key : SplitAt(p, '.')) {
      if (key.find_first_not_of("0123456789") == key.npos)
        key.erase(0, std::min(key.find_first_not_of('0'), key.size() - 1));
      all += key + ".";
    }
    return all;
  };
  return plain(path).starts_with(plain(other));
}

SweptValue::SweptValue(const std::string& text) : text_{text} {
  const std::size_t sign = text.find('=');
  if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
    Fail("expected path=values, such as payload.mass=0.5,1,2");
  path_ = text.substr(0, sign);
  const std::string values = text.substr(sign + 1);
  if (!ReadRandom(values) && !ReadSpaced(values)) ReadList(values);
  if (values_.size() > kMostValues)
    Fail("expected at most " + Text(kMostValues) + " values, got " + Text(values_.size()));
}

void SweptValue::Fail(const std::string& what) const {
  throw Error("swept " + Printable(text_.substr(0, 200)) + ": " + what);
}

bool SweptValue::ReadRandom(const std::string& values) {
  for (const auto& [word, law, rule] :
       {std::tuple("uniform(", Law::Uniform, "uniform(a,b) with a < b"),
        std::tuple("normal(", Law::Normal, "normal(mean,sigma) with sigma > 0")}) {
    if (!values.starts_with(word)) continue;
    const std::string inner = values.substr(std::string_view(word).size());
    const std::vector<std::string> parts =
        Split(std::string_view(inner).substr(0, std::max<std::size_t>(inner.size(), 1) - 1));
    const auto a = ReadNumber(parts[0]), b = ReadNumber(parts.size() == 2 ? parts[1] : "");
    const bool fit = inner.ends_with(')') && a && b && std::isfinite(*a) && std::isfinite(*b) &&
                     std::isfinite(*b - *a) && *b > (law == Law::Uniform ? *a : 0);
    if (!fit) Fail(std::string("expected ") + rule);
    law_ = law;
    a_ = *a;
    b_ = *b;
    return true;
  }
  return false;
}

bool SweptValue::ReadSpaced(const std::string& values) {
  const std::vector<std::string> parts = SplitAt(values, ':');
  if (parts.size() < 3 || !ReadNumber(parts[0])) return false;
  const auto from = ReadNumber(parts[0]), to = ReadNumber(parts[1]), count = ReadNumber(parts[2]);
  const bool logarithmic = parts.size() == 4 && parts[3] == "log";
  if (!to || !count || (parts.size() > 3 && !logarithmic) || !std::isfinite(*from) ||
      !std::isfinite(*to) || !std::isfinite(*to - *from) || *count != std::floor(*count) ||
      *count < 2 || *count > static_cast<double>(kMostValues) ||
      (logarithmic && !(*from > 0 && *to > 0)))
    Fail("expected from:to:count or from:to:count:log, with a count from 2 to " +
         Text(kMostValues) + (logarithmic ? ", and of logarithms from and to > 0" : ""));
  for (double k = 0; k < *count; ++k) {
    const double share = k / (*count - 1);
    values_.push_back(Rounded(k == 0            ? *from
                              : k == *count - 1 ? *to
                              : logarithmic     ? *from * std::pow(*to / *from, share)
                                                : *from + share * (*to - *from)));
  }
  return true;
}

void SweptValue::ReadList(const std::string& values) {
  values_ = Split(values);
  if (std::ranges::any_of(values_, &std::string::empty)) Fail("a value is empty");
  if (values.find_first_of("'\"[{") == values.npos && values.find('(') != values.npos)
    Fail("expected values, from:to:count, from:to:count:log, uniform(a,b) or normal(mean,sigma)");
}

double SweptValue::Draw(const RandomStream& stream) const {
  return law_ == Law::Uniform ? a_ + (b_ - a_) * stream.Uniform(0) : a_ + b_ * stream.Normal(0);
}

}  // namespace pliant
