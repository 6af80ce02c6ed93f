#include "pliant/systems/nearest_name.h"

#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

/// Levenshtein's distance, one row of its table at a time.
std::size_t Distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t replaced = diagonal + (a[i] != b[k]);
      diagonal = row[k + 1];
      row[k + 1] = std::min({replaced, row[k] + 1, row[k + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string DidYouMean(std::string_view name, const std::vector<std::string>& known) {
  if (known.empty()) return "";
  const auto distance = [&](const std::string& other) { return Distance(name, other); };
  return "; did you mean '" + *std::ranges::min_element(known, {}, distance) + "'?";
}

}  // namespace pliant
