#pragma once

#include <string>
#include <vector>

#include "pliant/systems/block.h"

namespace pliant {

/// How a velocity is made of counts.
enum class EncoderVelocity {
  Difference,  ///< of the counts of two ticks
  Period,      ///< by the ticks from one change of the count to the next
};
const std::vector<std::string>& Words(EncoderVelocity);

/// Encoders at joints: what is known of a position q is a whole number of counts, N to a turn,
/// taken every h,
///
///   c_k = round((q_k − q₀)/Δ),   Δ = 2π/N,   q̂_k = q₀ + Δ c_k,   |q̂_k − q_k| ≤ Δ/2
///
/// of an encoder that knows one turn only modulo N, so 0 ≤ c_k < N. The velocity is
///
///   Difference   v̂_k = Δ (c_k − c_{k−1})/h                                  error up to Δ/h
///   Period       v̂_k = Δ (c_k − c_j)/((k − j) h)                            where c has changed,
///                v̂_k = v̂_{k−1}, its size at most Δ/((k − j) h),             and where it has not,
///
/// j the tick of the last change before k. Slow motion is what Period is for: while |v| h < Δ its
/// error is up to |v| h / (Δ − |v| h) of v, and a joint that stops fades to zero. A turn or more in
/// a tick cannot be told from less of one that counts modulo N: |v| h < π. Source: Bélanger,
/// Dobrovolny, Helmy & Zhang, Int. J. Robotics Research 17 (1998) 1225.
class Encoder final : public Block {
 public:
  struct Options {
    Joints joints;
    PerJoint counts_per_turn;  ///< N, each whole and ≥ 1; of a quadrature encoder all four edges
    PerJoint offset = {};      ///< q₀ [rad], where the count is 0; none: zero
    bool one_turn = false;     ///< counts modulo N
    EncoderVelocity velocity = EncoderVelocity::Difference;
    Duration period;  ///< h
  };

  explicit Encoder(const Options& o);

  Input<JointPosition> position;
  Output<PerJoint> counts;                  ///< c
  Output<JointPosition> measured_position;  ///< q̂
  Output<JointVelocity> measured_velocity;  ///< v̂, 0 at the first tick

 private:
  /// When the counts changed last.
  struct Change {
    PerJoint counts;  // since then
    PerJoint ticks;   // from then on; before the first tick −1

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("counts", counts, "");
      f("ticks", ticks, "");
    }
  };

  PerJoint Count(const JointPosition& q) const;
  JointPosition MeasurePosition(const PerJoint& counts) const;
  JointVelocity MeasureVelocity(const JointVelocity& last, const PerJoint& counts,
                                const Change& change) const;
  Change Remember(const PerJoint& counts, const Change& change) const;
  double Moved(Eigen::Index joint, double now, double before) const;

  const PerJoint per_turn_, quantum_, offset_;
  const bool one_turn_;
  const EncoderVelocity velocity_;
  const double h_;
  Discrete<Change> change_;
};

}  // namespace pliant
