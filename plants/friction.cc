#include "pliant/plants/friction.h"

#include <cmath>
#include <numbers>

namespace pliant {

const std::vector<std::string>& Words(FrictionLaw) {
  static const std::vector<std::string> names{"none", "coulomb_viscous", "stribeck", "lugre",
                                              "elasto_plastic"};
  return names;
}

double StribeckCurve(const FrictionParameters& p, double velocity) {
  if (p.stiction == p.coulomb) return p.coulomb;
  const double x = velocity / p.stribeck_velocity;
  return p.coulomb + (p.stiction - p.coulomb) * std::exp(-x * x);
}

double SteadyFriction(const FrictionParameters& p, double velocity) {
  if (velocity == 0) return 0;
  return std::copysign(StribeckCurve(p, velocity), velocity) + p.viscous * velocity;
}

double SmoothFriction(FrictionLaw law, const FrictionParameters& p, double velocity) {
  if (law == FrictionLaw::None) return 0;
  const double level = law == FrictionLaw::Stribeck ? StribeckCurve(p, velocity) : p.coulomb;
  return level * std::tanh(velocity / p.zero_velocity) + p.viscous * velocity;
}

namespace {

/// α, with |z| where z has the sign of ω.
double PlasticPart(const FrictionParameters& p, double z, double z_most) {
  const double z_elastic = p.elastic_part * p.coulomb / p.bristle_stiffness;
  if (z <= z_elastic) return 0;
  if (z >= z_most) return 1;
  const double middle = 0.5 * (z_most + z_elastic);
  return 0.5 + 0.5 * std::sin(std::numbers::pi * (z - middle) / (z_most - z_elastic));
}

}  // namespace

double BristleRate(FrictionLaw law, const FrictionParameters& p, double z, double velocity) {
  const double z_most = StribeckCurve(p, velocity) / p.bristle_stiffness;
  if (z_most == 0) return 0;  // no dry friction: no bristles
  const double along = velocity < 0 ? -z : z;
  const double plastic = law == FrictionLaw::LuGre ? 1 : PlasticPart(p, along, z_most);
  return velocity * (1 - plastic * along / z_most);
}

}  // namespace pliant
