#pragma once

#include <optional>
#include <string>

#include "pliant/controllers/objective.h"
#include "pliant/controllers/velocity_damper.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Keeps the force between a link and what it touches below F⁺, whatever the tasks ask for. What is
/// touched is taken for a spring of stiffness k: with u = F/‖F‖, F the force on the robot, the
/// distance to F⁺ and its rates are
///
///   e = (F⁺ − ‖F‖)/k,   ė = uᵀ v,   ë = uᵀ (J q̈ + J̇ q̇) ≥ −λ ė − λ²/(4M²) e
///
/// One row, without a bound while ‖F‖ < F₀: what a sensor shows of its noise and of a tool that
/// moves is no contact, and has no direction. A push on an arm that rests beyond F⁺ makes it give
/// way. On a spring of k_s the loop is s² + λ s + λ²/(4M²) k_s/k, without overshoot for k_s ≤ M² k:
/// k is to be no less than the stiffest thing to be touched, over M².
///
/// With a direction n only the part of F along it counts, ‖F‖ = |nᵀF|, u = ± n. Friction of what is
/// touched turns F as the link slides, and a row that turns with it lets the task press harder.
///
/// Source: named as future work by Celerier et al. 2025; the damper is their (24).
class ForceLimit final : public Block {
 public:
  struct Options {
    RobotModel model;
    std::string frame;              ///< link in whose frame the wrench is; it acts at its origin
    double force = kToBeGiven;      ///< F⁺ [N], > 0
    double stiffness = kToBeGiven;  ///< k [N/m], > 0
    std::optional<Eigen::Vector3d> direction = {};  ///< n, world axes, of any length > 0
    double contact_from = 5;                        ///< F₀ [N], > 0, below F⁺
    VelocityDamper damper = {};
    int priority = 5;

    template <class F>
    void Parameters(F&& f) {
      f("frame", frame);
      f("force", force, "N", kPositive);
      f("stiffness", stiffness, "N/m", kPositive);
      f("direction", direction);
      f("contact_from", contact_from, "N", kPositive);
      f("damper", damper);
      f("priority", priority, "", Between(1, 100));
    }
  };

  explicit ForceLimit(const Options& o);

  Input<RobotDynamics> dynamics;
  Input<Wrench> contact;  ///< on the robot, in the frame
  Output<AccelerationRows> rows;

 private:
  void Limit(AccelerationRows& out, const RobotDynamics& d, const Wrench& contact) const;

  const Options o_;
  const int link_;
};

}  // namespace pliant
