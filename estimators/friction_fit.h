#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/plants/friction_file.h"

namespace pliant {

/// What is fitted to the friction torque y over the velocity ω of a joint that slides:
///
///   CoulombViscous   y = c sgn(ω) + d ω + b
///   Stribeck         y = (c + (s − c) exp(−(ω/ω_s)²)) sgn(ω) + d ω + b
///   LugreStatic      the same: it is the steady curve of LuGre, whose bristles need other tests
///
/// b is the offset of the torque sensor, if asked for.
enum class FrictionModel { CoulombViscous, Stribeck, LugreStatic };
const std::vector<std::string>& Words(FrictionModel);

/// What a residual r = y − ŷ of so many robust standard deviations σ counts, u = r/σ:
///
///   None     u²
///   Huber    u² up to |u| = k, then 2 k |u| − k²       k = 1.345
///   Cauchy   k² log(1 + u²/k²)                         k = 2.385
///
/// Both k give 95 % of the efficiency of least squares where the noise is normal.
/// Source: Holland & Welsch, Communications in Statistics A6, 1977.
enum class FrictionLoss { None, Huber, Cauchy };
const std::vector<std::string>& Words(FrictionLoss);

/// Of one joint, or of several that are taken for one.
struct FrictionSamples {
  Eigen::VectorXd velocity;  ///< ω [rad/s], in order of time
  Eigen::VectorXd torque;    ///< y = κ i − τ − B q̈ [N·m], with κ = η K_T G_r
  std::vector<Eigen::Index> begin = {0};  ///< the first sample of each stretch without a gap
  /// y at which a joint at rest broke away [N·m]; its sign is that of the motion that followed.
  Eigen::VectorXd break_away = {};
};

struct FrictionFitOptions {
  FrictionModel model = FrictionModel::CoulombViscous;
  FrictionLoss loss = FrictionLoss::Cauchy;
  bool separate = false;  ///< parameters of their own for ω > 0 and ω < 0
  bool offset = false;    ///< b is estimated too
  /// Slower samples do not slide [rad/s]; 0: 4 standard deviations of the noise of the mean that
  /// replaces ω, as the differences of ω tell it, and at least 0.005 rad/s.
  double least_velocity = 0;
  int folds = 5;  ///< of the cross-validation; 0: none
  /// σ of the loss [N·m] and the inefficiency, to compare models on common terms; 0: estimated.
  double scale = 0, inefficiency = 0;
};

/// What a fit found, and how far it can be trusted.
struct FrictionFit {
  FrictionFitOptions options;
  /// Of all parameters that could be told, in SI: coulomb, viscous, stiction, stribeck_velocity,
  /// each with _positive or _negative behind it if the directions are separate; offset.
  std::vector<FrictionEstimate> estimates;
  Eigen::MatrixXd covariance;
  struct Unidentified {
    std::string name, reason;
  };
  std::vector<Unidentified> unidentified;  ///< what the samples do not tell, and why

  Eigen::Index samples = 0;   ///< that slide
  double least_velocity = 0;  ///< [rad/s]
  double scale = 0;           ///< σ, 1.4826 times the median of |r| [N·m]
  double rms = 0;             ///< of r [N·m]
  double outliers = 0;        ///< share of |r| > 4 σ
  /// How many samples in a row tell as much as one that is independent: N/N_eff.
  double inefficiency = 1;
  Eigen::Index block = 1;  ///< samples that were taken together for the covariance
  /// Root mean square, over bins of velocity and of speeds that grow or fall, of what is left of r
  /// in the mean beyond its noise [N·m]: what the model cannot follow, a bias that no interval
  /// shows.
  double lack_of_fit = 0;
  bool lacks_fit = false;  ///< it is more than chance explains
  double aic = 0, bic = 0;
  double cross_validation = 0;  ///< robust standard deviation of r in samples held out [N·m]

  /// Throws Error if it was not identified.
  const FrictionEstimate& operator[](std::string_view name) const;
  const FrictionEstimate* Find(std::string_view name) const;
  /// "coulomb" and the like, of separate directions the mean; nothing if none was identified.
  struct Mean {
    double value, deviation;
  };
  std::optional<Mean> MeanOf(const std::string& name) const;
  /// ŷ(ω), without b; NaN if it cannot be told.
  double Curve(double velocity) const;
  /// For a file: of separate directions the means. A negative c, d or s is left out.
  IdentifiedFriction Identified(const std::string& joint) const;
};

/// Fits by Ceres, robust weights inside the residuals. Each velocity is first replaced by the mean
/// of up to 11 about it in its stretch that differ by no more than noise: what is left of the noise
/// would flatten the curve. The covariance is that of an M-estimator,
///
///   Σ = A⁻¹ (Σ_b u_b u_bᵀ) A⁻¹,   A = Σ_k ψ'(r_k) J_k J_kᵀ,   u_b = Σ_{k in b} ψ(r_k) J_k
///
/// over blocks b of neighbours, so long that their sums are uncorrelated: the length is the least
/// from which on the variance of block means does not grow (blocking). Intervals use Student's t
/// with as many degrees as blocks beyond parameters; that of ω_s is symmetric in log ω_s.
///
/// AIC and BIC are Σ ρ(r/σ)/I + 2p and + p log(N/I), with the inefficiency I. Folds of the
/// cross-validation are made of contiguous blocks. All three count the samples that slide and not
/// what broke away, so that models compare.
///
/// A parameter is not identified if the Jacobian, its columns scaled to 1, has a singular value
/// below 0.005 in whose direction it lies, if the velocities of a direction scatter hardly more
/// than their noise, and s and ω_s if s − c is not significant or nothing slides slowly enough.
/// With fewer than 20 samples that slide in a direction, neither its own parameters nor an offset
/// are.
///
/// Throws Error if there are not 10 samples for each parameter, or numbers that are not finite.
///
/// Sources: Huber & Ronchetti, Robust Statistics, 2nd ed., ch. 6–7; Newey & West, Econometrica 55,
/// 1987; Flyvbjerg & Petersen, J. Chem. Phys. 91, 1989; Ronchetti, Statistics & Probability Letters
/// 3, 1985.
FrictionFit FitFriction(const FrictionSamples& samples, const FrictionFitOptions& options);

/// Throws Error if an option is out of its range.
void RequireSound(const FrictionFitOptions& options);

/// What a mean of 11 velocities must reach to slide, and how many samples must do so.
double LeastVelocityOf(const FrictionSamples& samples, const FrictionFitOptions& options);
Eigen::Index LeastSamplesOf(const FrictionFitOptions& options);

/// How many samples slide.
struct SlidingCount {
  Eigen::Index positive = 0, negative = 0;

  Eigen::Index all() const { return positive + negative; }
  /// Enough in each direction to tell an offset from c.
  bool both() const;
};
SlidingCount CountSliding(const FrictionSamples& samples, const FrictionFitOptions& options);

/// CoulombViscous and Stribeck with the scale and inefficiency of the richer, so that AIC and BIC
/// compare; the one of least BIC comes first.
std::vector<FrictionFit> CompareFriction(const FrictionSamples& samples,
                                         const FrictionFitOptions& options);

/// Samples of joints of one size as those of one: each without its offset, if fits are given.
FrictionSamples Pooled(const std::vector<FrictionSamples>& joints,
                       const std::vector<FrictionFit>& fits);

/// The standard deviation of white noise on samples in a row that change slowly, from the median of
/// their second differences.
double NoiseOf(const Eigen::VectorXd& samples);

/// The upper one of the two in the middle, if they are even in number; 0 of none.
double MedianOf(std::vector<double> all);

}  // namespace pliant
