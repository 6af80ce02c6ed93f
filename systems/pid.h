#pragma once

#include "pliant/systems/block.h"
#include "pliant/systems/elements.h"

namespace pliant {

/// PID controller with filtered derivative and saturation, for each element, sampled every h. With
/// reference r, measured y, unsaturated v and output u:
///
///   P_k = kp (r_k − y_k)
///   D_k = (Tf D_{k−1} − kd (y_k − y_{k−1})) / (Tf + h),   D_0 = 0
///   v_k = P_k + I_k + D_k
///   u_k = min(max(v_k, lower), upper)
///   I_{k+1} = I_k + h ki (r_k − y_k) + h/Tt (u_k − v_k),   I_0 = 0
///
/// The derivative is that of y alone, so that steps of r give no kick. The last term is
/// anti-windup by back-calculation with the tracking time Tt; an element with ki = 0 keeps its I.
/// Source: Åström & Murray, Feedback Systems, 2008, sec. 10.5.
template <class S, class U>
class Pid final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    PerElement<S> kp;        ///< [unit of u per unit of y]
    PerElement<S> ki;        ///< [unit of u per unit of y and s]
    PerElement<S> kd;        ///< [unit of u · s per unit of y]
    double filter_s;         ///< Tf ≥ 0
    double tracking_time_s;  ///< Tt ≥ h
    U lower;
    U upper;
    Duration period;
  };

  explicit Pid(const Options& o)
      : reference{this, "reference", o.space},
        measured{this, "measured", o.space},
        kp{this, "kp", ElementSpace<S>(o.space), o.kp},
        ki{this, "ki", ElementSpace<S>(o.space), o.ki},
        kd{this, "kd", ElementSpace<S>(o.space), o.kd},
        lower{this, "lower", o.space, o.lower},
        upper{this, "upper", o.space, o.upper},
        u{this, "u", o.space},
        v_{this, "v", o.space},
        d_{this, "d", o.space},
        i_{this, "i", o.space},
        last_{this, "last", o.space},
        has_last_{this, "has_last"},
        h_{seconds(o.period)},
        Tf_{o.filter_s},
        Tt_{o.tracking_time_s} {
    Require(o.filter_s >= 0, "filter_s must be >= 0", o.filter_s);
    Require(o.tracking_time_s >= h_, "tracking_time_s must be >= the period", o.tracking_time_s);
    Require(Smallest(o.upper - o.lower) >= 0, "upper − lower must be >= 0",
            Smallest(o.upper - o.lower));
    const PeriodicEvent tick = Every(o.period);
    tick.Compute(d_).From(d_, kd, measured, last_, has_last_).As(&Pid::Damp);
    tick.Compute(v_).From(kp, reference, measured, i_, d_).As(&Pid::Add);
    tick.Compute(u).From(v_, lower, upper).As(&Pid::Saturate);
    tick.Update(i_).From(i_, ki, reference, measured, u, v_).As(&Pid::Integrate);
    tick.Update(last_).From(measured).As([](const S& y) { return y; });
    tick.Update(has_last_).From().As([] { return true; });
  }

  Input<S> reference, measured;
  Input<PerElement<S>> kp, ki, kd;
  Input<U> lower, upper;
  Output<U> u;

 private:
  using Gain = PerElement<S>;

  U Damp(const U& D, const Gain& k, const S& y, const S& last, bool has_last) const {
    if (!has_last) return D;
    const auto damp = [this](double d, double gain, double now, double before) {
      return (Tf_ * d - gain * (now - before)) / (Tf_ + h_);
    };
    return EachElement<U>(damp, D, k, y, last);
  }
  U Add(const Gain& k, const S& r, const S& y, const U& I, const U& D) const {
    return EachElement<U>([](double gain, double goal, double now, double i,
                             double d) { return gain * (goal - now) + i + d; },
                          k, r, y, I, D);
  }
  U Saturate(const U& v, const U& least, const U& most) const {
    return EachElement<U>(
        [](double x, double lo, double hi) { return x > hi   ? hi
                                                    : x < lo ? lo
                                                             : x; }, v, least,
        most);
  }
  U Integrate(const U& I, const Gain& k, const S& r, const S& y, const U& out, const U& v) const {
    const auto integrate = [this](double i, double gain, double goal, double now, double sat,
                                  double unsat) {
      return gain == 0 ? i : i + h_ * gain * (goal - now) + h_ / Tt_ * (sat - unsat);
    };
    return EachElement<U>(integrate, I, k, r, y, out, v);
  }

  Output<U> v_, d_;
  Discrete<U> i_;
  Discrete<S> last_;
  Discrete<bool> has_last_;
  const double h_, Tf_, Tt_;
};

}  // namespace pliant
