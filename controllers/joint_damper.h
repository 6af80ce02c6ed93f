#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/controllers/objective.h"
#include "pliant/controllers/velocity_damper.h"
#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Keeps joints inside their position and velocity limits by second-order velocity dampers. With e
/// the distance to a limit (e = q⁺ − q above, q − q⁻ below), d_s the safety distance and ė_min =
/// −q̇⁺:
///
///   ë ≥ max(ë_p, ë_v)                            (EC 19)
///   ë_p = −λ ė − λ²/(4M²) (e − d_s)              (EC 24)
///   ë_v = −λ (ė − ė_min)                         (EC 18, with λ for 1/δt)
///
/// M > 1 makes the approach overdamped: a joint that sets out at rest and keeps to its bounds comes
/// up to e = d_s and q̇⁺ and passes neither, also when sampled and held every h ≤ 1/λ. Continuous
/// joints have no position limit. Further than 4M² q̇⁺/λ outside of a limit ë_p asks for more speed
/// than ë_v of the other end allows: there lower > upper.
///
/// The classical form, for comparison, depends on the sample δt and begins at the distance d_i:
///
///   ë_p = −(ė − ė_d)/δt,   ė_d = −ξ (e − d_s)/(d_i − d_s),   where e < d_i             (EC 15, 17)
///   ξ = |ė| (d_i − d_s)/(e − d_s) + ξ₀   at the tick at which e falls below d_i, kept until it
///   rises ë_v = −(ė − ė_min)/δt                                                                (EC
///   18)
///
/// Source: Celerier et al. 2025 (EC); λ = 100 1/s, M = 2, d_s = 1 % of the range as recommended
/// there. Classical: Vaillant et al., Autonomous Robots 40(3), 2016; ξ, d_i and ξ₀ as in mc_rtc.
class JointDamper final : public Block {
 public:
  enum class Form { Proposed, Classical };

  friend const std::vector<std::string>& Words(Form) {
    static const std::vector<std::string> words{"proposed", "classical"};
    return words;
  }

  struct Options {
    RobotModel model;
    double rate = 100;              ///< λ [1/s], > 0
    double damping_ratio = 2;       ///< M ≥ 1
    double safety_distance = 0.01;  ///< d_s as a fraction of a joint's range, in [0, 0.5)
    double velocity_fraction = 1;   ///< of the model's velocity limit, in (0, 1]
    Form form = Form::Proposed;
    double influence_distance = 0.1;  ///< d_i as a fraction of a joint's range, > safety_distance
    double speed_offset = 0.5;        ///< ξ₀ [rad/s], > 0
    Duration step = 1ms;              ///< δt of the classical form

    template <class F>
    void Parameters(F&& f) {
      f("rate", rate, "1/s", kPositive);
      f("damping_ratio", damping_ratio, "", Range{.least = 1});
      f("safety_distance", safety_distance, "",
        Range{.least = 0, .most = 0.5, .without_most = true});
      f("velocity_fraction", velocity_fraction, "",
        Range{.least = 0, .most = 1, .without_least = true});
      f("form", form);
      f("influence_distance", influence_distance, "",
        Range{.least = 0, .most = 1, .without_least = true});
      f("speed_offset", speed_offset, "rad/s", kPositive);
      f("step", step);
    }
  };

  explicit JointDamper(const Options& o);

  Input<RobotDynamics> dynamics;
  Output<AccelerationBounds> bounds;

 private:
  void Bound(AccelerationBounds& out, const RobotDynamics& d) const;
  /// ξ of the upper and of the lower limits; 0 outside of d_i.
  struct Approach {
    PerJoint upper, lower;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("upper", upper, "rad/s");
      f("lower", lower, "rad/s");
    }
  };
  Approach Enter(const Approach& last, const RobotDynamics& d) const;
  void BoundClassically(AccelerationBounds& out, const RobotDynamics& d, const Approach& xi) const;

  const VelocityDamper law_;
  const double xi0_, step_;
  const PerJoint lower_, upper_, speed_;      // with d_s taken off; ∓∞ for continuous joints
  const PerJoint influence_;                  // d_i − d_s; ∞ for continuous joints
  std::optional<Output<Approach>> approach_;  // of the classical form
};

}  // namespace pliant
