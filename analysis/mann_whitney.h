#pragma once

#include <vector>

namespace pliant {

/// How the distribution of U was had.
enum class NullDistribution {
  kExact,          ///< counted, no two values equal
  kExactWithTies,  ///< counted over all ways to deal these values out, equal ones among them
  kNormal          ///< approximated, corrected for ties and for U being discrete
};

struct MannWhitneyOptions {
  /// n m up to which the distribution is counted, at most 10 000; 0: never. Time grows with
  /// (n + m) n² m.
  int exact_pairs = 2500;
};

/// Whether values of one population tend to be larger than those of another, by ranks only:
///
///   U = #{(i, j): xᵢ > yⱼ} + ½ #{(i, j): xᵢ = yⱼ},   0 ≤ U ≤ n m
///   r = 2 U / (n m) − 1
///
/// Under the null hypothesis all n + m values come from one distribution.
///
/// Sources: Mann & Whitney, Ann. Math. Statist. 18 (1947), 50; Lehmann, Nonparametrics (1975), ch.
/// 1, for ties; Wendt, Eur. J. Soc. Psychol. 2 (1972), 463, for r.
struct MannWhitney {
  double u;              ///< U, of the first sample
  double rank_biserial;  ///< r: 1 if every value of the first sample is larger, −1 if smaller
  double p_greater;      ///< P(U ≥ u): small if the first sample is larger
  double p_less;         ///< P(U ≤ u): small if the first sample is smaller
  double p_two_sided;    ///< twice the smaller of the two, at most 1
  NullDistribution distribution;
};

/// Of two samples of one finite value or more each.
MannWhitney MannWhitneyTest(const std::vector<double>& first, const std::vector<double>& second,
                            const MannWhitneyOptions& options = {});

}  // namespace pliant
