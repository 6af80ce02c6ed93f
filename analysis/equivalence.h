#pragma once

#include <vector>

#include "pliant/analysis/interval.h"
#include "pliant/analysis/mann_whitney.h"

namespace pliant {

struct EquivalenceOptions {
  double margin;        ///< Δ, > 0: what is too small to matter, in the unit of the values
  double alpha = 0.05;  ///< level of the claim of equivalence, 0 < α < 0.5
};

/// That two means differ by less than a margin, shown by two one-sided tests:
///
///   d = x̄ − ȳ,   e² = s₁²/n₁ + s₂²/n₂,   t± = (d ± Δ) / e
///   p = max(P(T > t₊), P(T < t₋)),   T Student's t with Welch's degrees of freedom
///
/// Equal to d ± t₁₋α e lying within ±Δ. A large p shows nothing, not even a difference.
/// Sources: Schuirmann, J. Pharmacokinet. Biopharm. 15 (1987), 657; Welch, Biometrika 34
/// (1947), 28.
struct EquivalenceOfMeans {
  double difference;          ///< d
  double degrees_of_freedom;  ///< Welch's, e⁴ / Σ (sᵢ²/nᵢ)²/(nᵢ − 1)
  double p_above_lower;       ///< P(T > t₊): small if d is well above −Δ
  double p_below_upper;       ///< P(T < t₋): small if d is well below Δ
  double p;                   ///< the larger of the two
  Interval interval;          ///< d ± t₁₋α e, of confidence 1 − 2 α
  bool equivalent;            ///< p < α
};

/// Of two samples of two values or more, not both constant.
EquivalenceOfMeans TestEquivalenceOfMeans(const std::vector<double>& first,
                                          const std::vector<double>& second,
                                          const EquivalenceOptions& options);

/// The same by ranks, for two distributions of one shape, one shifted against the other: the first
/// sample, raised by Δ, is larger than the second; lowered by Δ, it is smaller.
///
/// Source: Wellek, Testing Statistical Hypotheses of Equivalence, 2nd ed. (2010), ch. 6.
struct EquivalenceOfRanks {
  double difference;     ///< median of all xᵢ − yⱼ (Hodges & Lehmann 1963)
  double p_above_lower;  ///< MannWhitneyTest(x + Δ, y).p_greater
  double p_below_upper;  ///< MannWhitneyTest(x − Δ, y).p_less
  double p;              ///< the larger of the two
  bool equivalent;       ///< p < α
};

/// Of two samples of one value or more.
EquivalenceOfRanks TestEquivalenceOfRanks(const std::vector<double>& first,
                                          const std::vector<double>& second,
                                          const EquivalenceOptions& options,
                                          const MannWhitneyOptions& ranks = {});

}  // namespace pliant
