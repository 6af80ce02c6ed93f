#pragma once

#include "pliant/systems/block.h"

namespace pliant {

/// The external torque below K/2π Hz from a momentum observer and above it from a wrist sensor:
///
///   τ̂_e = r + s/(K + s) τ_s,   τ_s = J_sᵀ F_s
///
/// with the same K as the observer. The high-pass is τ_s,k − l_k, with l filtered as the observer
/// filters, from the first tick on,
///
///   l_k = e^{−K h} l_{k−1} + (1 − e^{−K h}) ½ (τ_s,k + τ_s,k−1),   l_0 = 0
///
/// so where τ_s = τ_e and changes evenly over each sample, the sum is τ_e exactly.
///
/// While the sensor is not valid, τ̂_e = r. When it is valid again the high-pass begins anew from
/// what it shows then, l = τ_s, so that tick has τ̂_e = r as well and nothing jumps; τ_s may be
/// anything before.
///
/// Source: Celerier et al. 2025 (26).
class ComplementaryFusion final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint gain;    ///< K [1/s], each > 0, the observer's
    Duration period;  ///< h
  };

  struct Memory {
    using Space = Joints;
    static constexpr Quantity quantity{"complementary fusion memory", ""};

    JointTorque low;   ///< l
    JointTorque last;  ///< τ_s
    bool started = false;
    bool sensed = false;  ///< the sensor is valid at this tick
    bool adds = false;    ///< and is part of the sum

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("low", low, "N·m");
      f("last", last, "N·m");
      f("started", started, "");
      f("sensed", sensed, "");
      f("adds", adds, "");
    }
  };

  explicit ComplementaryFusion(const Options& o);

  Input<JointTorque> residual;          ///< r
  Input<JointTorque> sensor_torque;     ///< τ_s
  Input<bool> sensor_valid;             ///< true if not connected
  Output<JointTorque> external_torque;  ///< τ̂_e

 private:
  Memory Next(const Memory& last, const JointTorque& tau_s, bool valid) const;
  JointTorque Fuse(const JointTorque& r, const Memory& m) const;

  const PerJoint decay_;  // e^{−K h}
  Output<Memory> memory_;
};

}  // namespace pliant
