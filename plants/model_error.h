#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pliant/plants/actuator_parameters.h"
#include "pliant/plants/robot_model.h"

namespace pliant {

/// By how much a controller's model is wrong on purpose: half-widths δ of uniform distributions,
/// relative to the figures of the right model. Each link with mass m, centre c and, about c,
/// inertia I and second moment Σ = ½ tr(I) 1 − I gets
///
///   m' = s m,   c' = c + δ_c ρ u,   Σ' = s A Σ Aᵀ,   I' = tr(Σ') 1 − Σ'
///   s = 1 + δ_m u,   A = 1 + ½ δ_I E,   ρ = √(tr(Σ)/m)
///
/// ρ is the root mean square distance of the link's mass from its centre. Every u and every element
/// of the vector u and of the symmetric matrix E is uniform in (−1, 1), in the axes of the link,
/// and independent of the others. About principal axes Σ_ii changes by δ_I E_ii Σ_ii, to first
/// order.
///
/// Such a link could be built: s > 0, and a congruence keeps Σ ⪰ 0, which is the triangle
/// inequality of the moments of inertia; A is regular for δ_I < 2/3, so that Σ ≻ 0 and I ≻ 0 stay
/// so.
///
/// The Coulomb friction and stiction of a joint grow by one factor 1 + δ_f u, so that their ratio
/// stays; its viscous friction grows by another.
///
/// A number is a function of the seed, the index of the link or joint and its use: neither a
/// payload nor another half-width changes it.
///
/// Source of Σ: Wensing, Kim & Slotine, IEEE Robotics and Automation Letters 3(1), 2018.
struct ModelError {
  struct Payload {
    std::string link;
    Inertial inertial;
  };

  double mass = 0;      ///< δ_m; 0.1: within ± 10 %
  double center = 0;    ///< δ_c
  double inertia = 0;   ///< δ_I
  double friction = 0;  ///< δ_f
  std::uint64_t seed = 0;
  std::optional<Payload> payload = {};  ///< that the robot does not carry; as it is, without error

  template <class F>
  void Parameters(F&& f) {
    f("mass", mass, "", Between(0, 1));
    f("center", center, "", Between(0, 1));
    f("inertia", inertia, "", Between(0, 1));
    f("friction", friction, "", Between(0, 1));
  }
};

/// The model with wrong links. With no error, all its figures are those of `model`.
RobotModel Perturbed(const RobotModel& model, const ModelError& error);

/// The actuators with wrong friction.
ArmActuators Perturbed(const ArmActuators& actuators, const ModelError& error);

}  // namespace pliant
