#pragma once

#include <string>

#include "pliant/controllers/compliance.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Leads a compliance to the wanted one on a straight way, sampled every h, with N = T/h ticks left
/// when a new one is wanted and one less at each tick:
///
///   Γ_k = Γ_{k−1} + (Γ_wanted − Γ_{k−1}) / N_k
///
/// so from Γ_a to Γ_b it moves by (Γ_b − Γ_a) h/T a tick and arrives after T. All on the way are
/// symmetric positive semi-definite, as the set of these is convex. A wish that changes before that
/// starts a new way of T from where Γ is. What is no compliance is refused: the way to the last one
/// that was goes on, and `refused` says so as long as that is wanted.
///
/// Γ_k holds over the sample that begins at tick k.
template <class Matrix>
class ComplianceRamp final : public Block {
 public:
  struct Options {
    int size;           ///< rows of Γ
    Matrix start = {};  ///< at the start, as ComplianceOf reads it
    Duration time;      ///< T, at least h
    Duration period;    ///< h
  };

  explicit ComplianceRamp(const Options& o)
      : wanted{this, "wanted", {}, Start(o)},
        compliance{this, "compliance", {}, Start(o)},
        refused{this, "refused"},
        ticks_{Ticks(o)},
        way_{this, "way", {}, {Start(o), Start(o), 0, false}} {
    Every(o.period).Compute(way_).From(way_, wanted).As(&ComplianceRamp::Next);
    Compute(compliance).From(way_).As([](const Way& w) { return w.now; });
    Compute(refused).From(way_).As([](const Way& w) { return w.refused; });
  }

  Input<Matrix> wanted;
  Output<Matrix> compliance;
  Output<bool> refused;

 private:
  struct Way {
    Matrix now, goal;
    int left = 0;  ///< ticks to go
    bool refused = false;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("now", now, "");
      f("goal", goal, "");
      f("left", left, "");
      f("refused", refused, "");
    }
  };

  static Matrix Start(const Options& o) {
    Require(o.size >= 1 && o.size <= Matrix::MaxRowsAtCompileTime,
            "size must be from 1 to " + Text(int{Matrix::MaxRowsAtCompileTime}), o.size);
    return ComplianceOf<Matrix>(o.start, o.size, "start");
  }

  static int Ticks(const Options& o) {
    Require(!(o.time < o.period), "time must be at least the period, " + o.period.text(),
            o.time.text());
    return static_cast<int>(seconds(o.time) / seconds(o.period) + 0.5);
  }

  void Next(Way& way, const Way& last, const Matrix& wish) const {
    way = last;
    const Eigen::Index n = way.goal.rows();
    const bool wanted_before = wish.rows() == n && wish.cols() == n && wish == way.goal;
    way.refused = !wanted_before && !IsCompliance(wish, n);
    if (!wanted_before && !way.refused) {
      way.goal = wish;
      way.left = ticks_;
    }
    if (way.left == 0) return;
    way.now += (way.goal - way.now) / way.left;
    if (--way.left == 0) way.now = way.goal;
  }

  const int ticks_;
  Output<Way> way_;
};

}  // namespace pliant
