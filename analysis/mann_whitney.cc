#include "pliant/analysis/mann_whitney.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/analysis/distributions.h"
#include "pliant/analysis/sample.h"
#include "pliant/systems/error.h"

namespace pliant {

namespace {

struct Value {
  double x;
  bool of_first;
};

/// Both samples in ascending order.
std::vector<Value> Pool(const std::vector<double>& first, const std::vector<double>& second) {
  std::vector<Value> all;
  for (const double x : first) all.push_back({.x = x, .of_first = true});
  for (const double x : second) all.push_back({.x = x, .of_first = false});
  std::ranges::sort(all, {}, &Value::x);
  return all;
}

/// What the test needs to know of the values: how many are equal to each other, in ascending order,
/// and 2 U, which is whole.
struct Ranking {
  std::vector<std::size_t> groups;
  std::size_t twice_u = 0;
};

Ranking Rank(const std::vector<double>& first, const std::vector<double>& second) {
  const std::vector<Value> all = Pool(first, second);
  Ranking ranking;
  std::size_t second_below = 0;
  for (auto begin = all.begin(); begin != all.end();) {
    const auto end =
        std::find_if(begin, all.end(), [begin](const Value& v) { return v.x != begin->x; });
    const auto size = static_cast<std::size_t>(end - begin);
    const auto of_first = static_cast<std::size_t>(
        std::count_if(begin, end, [](const Value& v) { return v.of_first; }));
    ranking.groups.push_back(size);
    ranking.twice_u += of_first * (2 * second_below + size - of_first);
    second_below += size - of_first;
    begin = end;
  }
  return ranking;
}

/// In how many ways n of the values can be dealt to the first sample so that 2 U is 0, 1, … 2 n m.
///
/// Group after group: from a group of t equal values, s values below it and k of those dealt, c are
/// dealt in (t over c) ways and add c (2 (s − k) + t − c) to 2 U. With groups of one this is the
/// recursion of Mann & Whitney. Sums of positive numbers: whole and exact below 2⁶⁴, and good to
/// n + m last digits beyond.
std::vector<long double> Count(const std::vector<std::size_t>& groups, std::size_t n,
                               std::size_t m) {
  std::vector<std::vector<long double>> ways(n + 1, std::vector<long double>(2 * n * m + 1, 0));
  ways[0][0] = 1;
  std::size_t s = 0;
  for (const std::size_t t : groups) {
    for (std::size_t k = std::min(n, s) + 1; k-- > 0;) {
      if (s - k > m) break;
      const std::size_t most = 2 * k * (s - k);  // 2 U of the values so far
      long double choices = 1;
      for (std::size_t c = 1; c <= std::min(t, n - k); ++c) {
        choices = choices * static_cast<long double>(t - c + 1) / static_cast<long double>(c);
        const std::size_t above = s - k + (t - c);  // of the second sample, this group included
        if (above > m) continue;
        const std::size_t added = c * (2 * (s - k) + t - c);
        for (std::size_t u = 0; u <= most; ++u) ways[k + c][u + added] += choices * ways[k][u];
      }
    }
    s += t;
  }
  return ways[n];
}

/// P(U ≤ u) and P(U ≥ u).
struct Tails {
  double less, greater;
};

Tails Counted(const Ranking& ranking, std::size_t n, std::size_t m) {
  // The smaller sample is dealt; the other one's U is n m − U.
  const bool swap = n > m;
  const std::vector<long double> ways = Count(ranking.groups, std::min(n, m), std::max(n, m));
  const auto at = ways.begin() +
                  static_cast<std::ptrdiff_t>(swap ? 2 * n * m - ranking.twice_u : ranking.twice_u);
  const long double all = std::accumulate(ways.begin(), ways.end(), 0.0L);
  const auto below = static_cast<double>(std::accumulate(ways.begin(), at + 1, 0.0L) / all);
  const auto above = static_cast<double>(std::accumulate(at, ways.end(), 0.0L) / all);
  return swap ? Tails{.less = above, .greater = below} : Tails{.less = below, .greater = above};
}

/// Lehmann (1975), ch. 1, with the continuity correction ½.
Tails Approximated(const Ranking& ranking, double n, double m) {
  const double total = n + m;
  const double ties = std::accumulate(ranking.groups.begin(), ranking.groups.end(), 0.0,
                                      [](double sum, std::size_t size) {
                                        const auto t = static_cast<double>(size);
                                        return sum + (t * t * t - t);
                                      });
  const double deviation = std::sqrt(n * m / 12 * (total + 1 - ties / (total * (total - 1))));
  const double off = static_cast<double>(ranking.twice_u) / 2 - n * m / 2;
  // All values equal: no deviation, nothing off, and both are 1.
  return {.less = internal::NormalBelow((off + 0.5) / deviation),
          .greater = internal::NormalAbove((off - 0.5) / deviation)};
}

}  // namespace

MannWhitney MannWhitneyTest(const std::vector<double>& first, const std::vector<double>& second,
                            const MannWhitneyOptions& options) {
  internal::RequireSample(first, "the first sample", 1);
  internal::RequireSample(second, "the second sample", 1);
  Require(options.exact_pairs >= 0 && options.exact_pairs <= 10'000,
          "exact_pairs must lie in 0 … 10000", options.exact_pairs);
  const auto n = static_cast<double>(first.size()), m = static_cast<double>(second.size());
  const Ranking ranking = Rank(first, second);
  const bool exact = n * m <= options.exact_pairs;
  const bool ties = ranking.groups.size() < first.size() + second.size();
  const Tails p =
      exact ? Counted(ranking, first.size(), second.size()) : Approximated(ranking, n, m);
  const double u = static_cast<double>(ranking.twice_u) / 2;
  return {.u = u,
          .rank_biserial = 2 * u / (n * m) - 1,
          .p_greater = p.greater,
          .p_less = p.less,
          .p_two_sided = std::min(1.0, 2 * std::min(p.less, p.greater)),
          .distribution = !exact ? NullDistribution::kNormal
                          : ties ? NullDistribution::kExactWithTies
                                 : NullDistribution::kExact};
}

}  // namespace pliant
