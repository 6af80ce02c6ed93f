#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pliant/estimators/friction_fit.h"

namespace pliant::internal {

/// Of the normal distribution, two-sided 95 %.
inline constexpr double kNormal95 = 1.959963984540054;

/// The parameters in their order: [c, d, (s, log ω_s)], of ω > 0 and then of ω < 0 if they are
/// separate, and b.
struct Shape {
  bool stribeck, separate, offset;

  int each() const { return stribeck ? 4 : 2; }
  int size() const { return (separate ? 2 : 1) * each() + (offset ? 1 : 0); }
  int begin(double direction) const { return separate && direction < 0 ? each() : 0; }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const char* behind : {"_positive", "_negative"}) {
      if (!separate && !all.empty()) break;
      for (const char* name : {"coulomb", "viscous", "stiction", "stribeck_velocity"})
        if (stribeck || name[0] != 's') all.push_back(name + std::string(separate ? behind : ""));
    }
    if (offset) all.push_back("offset");
    return all;
  }

  /// ŷ, and its derivatives by the parameters if there is room for them. ω = ±0 is the limit.
  double operator()(const double* x, double velocity, double* J) const {
    const double sign = std::signbit(velocity) ? -1 : 1;
    const double* p = x + begin(sign);
    if (J) std::fill_n(J, size(), 0.0);
    double* Jp = J ? J + begin(sign) : nullptr;
    double level = p[0], E = 0;
    if (stribeck) {
      const double ratio = velocity * std::exp(-p[3]), square = ratio * ratio;
      E = std::exp(-square);
      level += (p[2] - p[0]) * E;
      if (Jp) {
        Jp[2] = sign * E;
        Jp[3] = sign * (p[2] - p[0]) * E * 2 * square;
      }
    }
    if (Jp) {
      Jp[0] = sign * (1 - E);
      Jp[1] = velocity;
      if (offset) J[size() - 1] = 1;
    }
    return sign * level + p[1] * velocity + (offset ? x[size() - 1] : 0);
  }
};

/// ρ(u), ψ = ½ ρ', ψ'.
struct Influence {
  double rho, psi, slope;
};
Influence InfluenceOf(FrictionLoss loss, double u);

/// y − ŷ(ω).
Eigen::VectorXd Residuals(const Shape& shape, const Eigen::VectorXd& x,
                          const Eigen::VectorXd& velocity, const Eigen::VectorXd& torque);

/// x, from where it is, to what makes Σ ρ(r/σ) least.
void Solve(const Shape& shape, FrictionLoss loss, double scale, const Eigen::VectorXd& velocity,
           const Eigen::VectorXd& torque, Eigen::VectorXd& x);

/// At most so many of all, evenly.
Eigen::VectorXd Thinned(const Eigen::VectorXd& all, Eigen::Index most);

/// x = argmin Σ ρ(r/σ), and σ.
struct Solution {
  Eigen::VectorXd x;
  double scale;
};

Solution SolutionOf(const Shape& shape, const FrictionFitOptions& o,
                    const Eigen::VectorXd& velocity, const Eigen::VectorXd& torque);

/// How many neighbours tell as much as one sample that is independent.
struct Blocking {
  Eigen::Index length = 1;
  double inefficiency = 1;
};

/// The least block length from which on the variance of sums, over their length, does not grow.
Blocking BlockingOf(const Eigen::VectorXd& psi, const std::vector<Eigen::Index>& begin);

/// Of Student's t, two-sided 95 %, n ≥ 1 degrees.
double Student95(double degrees);

/// What is known of x: its covariance, and what has none.
struct Certainty {
  Eigen::MatrixXd covariance;
  std::vector<bool> unknown;
  double quantile = kNormal95;
};

Certainty CertaintyOf(const Shape& shape, FrictionLoss loss, const Solution& at,
                      const Eigen::VectorXd& velocity, const Eigen::VectorXd& torque,
                      const std::vector<Eigen::Index>& begin, Eigen::Index block);

}  // namespace pliant::internal
