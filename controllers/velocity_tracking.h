#pragma once

#include "pliant/systems/block.h"
#include "pliant/systems/parameter.h"

namespace pliant {

/// Tracking of a velocity:
///
///   ė_p = ṗ̃_d − ṗ,   ṗ_c = k_p ė_p + k_d ë_p                                           (NS 5)
///
/// ë_p comes from outside: a FilteredDerivative of `error` makes it of what can be measured, and
/// its filter is the one the derivative has.
///
/// Source: Yang, Wang & Kermani 2025 (NS).
class VelocityTracking final : public Block {
 public:
  struct Options {
    double gain;             ///< k_p > 0
    double rate_gain_s = 0;  ///< k_d ≥ 0 [s]
  };

  explicit VelocityTracking(const Options& o) : o_{o} {
    RequireInRange("", "gain", o.gain, "", kPositive);
    RequireInRange("", "rate_gain_s", o.rate_gain_s, "s", kNotNegative);
    Compute(error)
        .From(desired, velocity)
        .As([](const LinearVelocity& wanted, const LinearVelocity& v) {
          return LinearVelocity(wanted - v);
        });
    Compute(command).From(error, error_rate).As(&VelocityTracking::Track);
  }

  Input<LinearVelocity> desired{this, "desired"};    ///< ṗ̃_d
  Input<LinearVelocity> velocity{this, "velocity"};  ///< ṗ
  /// ë_p; 0 if not connected
  Input<LinearAcceleration> error_rate{this, "error_rate", {}, LinearAcceleration{}};
  Output<LinearVelocity> error{this, "error"};      ///< ė_p
  Output<LinearVelocity> command{this, "command"};  ///< ṗ_c

 private:
  LinearVelocity Track(const LinearVelocity& e, const LinearAcceleration& rate) const {
    return o_.gain * e + o_.rate_gain_s * rate;
  }

  const Options o_;
};

}  // namespace pliant
