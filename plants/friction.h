#pragma once

#include <string>
#include <vector>

#include "pliant/systems/parameter.h"

namespace pliant {

/// How the friction of a joint follows from its velocity ω, with the Stribeck curve
///
///   g(ω) = c + (s − c) exp(−(ω/ω_s)²)
///
///   None               τ_f = 0
///   CoulombViscous     τ_f = c tanh(ω/ω₀) + d ω
///   Stribeck           τ_f = g(ω) tanh(ω/ω₀) + d ω
///   LuGre              τ_f = σ₀ z + σ₁ ż + d ω,   ż = ω − σ₀ |ω| z/g(ω)
///   ElastoPlastic      the same with                ż = ω (1 − α(z, ω) sgn(ω) σ₀ z/g(ω))
///
/// z is the mean deflection of the bristles between the surfaces, σ₀ z → g(ω) sgn(ω) at constant ω.
/// α = 0 while |z| is below z_b = β c/σ₀ or z opposes ω, 1 from g(ω)/σ₀ on, and a sine between:
/// below break-away the bristles only bend, so an arm at rest stays where it is under any load that
/// varies. LuGre's arm creeps. CoulombViscous and Stribeck have no rest: they creep at |ω| ≪ ω₀.
///
/// Both bristle laws take energy only, at every instant, if d ≥ σ₁ (s − c)/c, so always for s = c.
///
/// Source: Canudas de Wit, Olsson, Åström & Lischinsky, IEEE Trans. Automatic Control 40(3), 1995;
/// Dupont, Hayward, Armstrong & Altpeter, IEEE Trans. Automatic Control 47(5), 2002, (8)–(14).
enum class FrictionLaw { None, CoulombViscous, Stribeck, LuGre, ElastoPlastic };

/// none, coulomb_viscous, stribeck, lugre, elasto_plastic.
const std::vector<std::string>& Words(FrictionLaw);

/// Of one joint, behind the gear.
struct FrictionParameters {
  double coulomb = kToBeGiven;     ///< c [N·m]
  double viscous = kToBeGiven;     ///< d [N·m·s/rad]
  double stiction = kToBeGiven;    ///< s ≥ c, breaks the joint away slowly [N·m]
  double stribeck_velocity = 0.1;  ///< ω_s [rad/s]
  double zero_velocity = 1e-3;     ///< ω₀, of the laws without bristles [rad/s]
  double bristle_stiffness = 1e4;  ///< σ₀ [N·m/rad]
  double bristle_damping = 0;      ///< σ₁ [N·m·s/rad]
  double elastic_part = 0.8;       ///< β, the part of c up to which bristles only bend

  template <class F>
  void Parameters(F&& f) {
    f("coulomb", coulomb, "N·m", kNotNegative);
    f("viscous", viscous, "N·m·s/rad", kNotNegative);
    f("stiction", stiction, "N·m", Range{.least = coulomb});
    f("stribeck_velocity", stribeck_velocity, "rad/s", kPositive);
    f("zero_velocity", zero_velocity, "rad/s", kPositive);
    f("bristle_stiffness", bristle_stiffness, "N·m/rad", kPositive);
    f("bristle_damping", bristle_damping, "N·m·s/rad", kNotNegative);
    f("elastic_part", elastic_part, "", Between(0, 0.99));
  }

  bool operator==(const FrictionParameters&) const = default;
};

/// g(ω) [N·m].
double StribeckCurve(const FrictionParameters& p, double velocity);

/// τ_f of the bristle laws at constant ω [N·m]: g(ω) sgn(ω) + d ω; 0 at ω = 0.
double SteadyFriction(const FrictionParameters& p, double velocity);

/// τ_f of the laws without bristles [N·m].
double SmoothFriction(FrictionLaw law, const FrictionParameters& p, double velocity);

/// ż of the bristle laws [rad/s].
double BristleRate(FrictionLaw law, const FrictionParameters& p, double deflection,
                   double velocity);

}  // namespace pliant
