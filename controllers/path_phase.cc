#include "pliant/controllers/path_phase.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

TaskVector Zero(int size) {
  Require(size >= 1 && size <= 6, "size must be from 1 to 6", size);
  return TaskVector::Zero(size);
}

}  // namespace

PathPhase::PathPhase(const Options& o)
    : error{this, "error", {}, Zero(o.size)},
      phase{this, "phase", {}, PathTime{.by_clock = false}},
      o_{o},
      state_{this, "state"} {
  RequireInRange("", o);
  Require(o.free < o.stop, "stop must be > free, " + Text(o.free), o.stop);
  Every(o.period).Update(state_).From(clock, state_, error).As(&PathPhase::Next);
  Compute(phase).From(clock, state_).As(&PathPhase::Phase);
}

PathPhase::State PathPhase::At(double t, const State& x) const {
  const double T = o_.lag_s, s = t - x.since, gone = -std::expm1(-s / T);
  return {t, x.deficit + (1 - x.goal) * s - (x.rate - x.goal) * T * gone,
          x.rate + (x.goal - x.rate) * gone, x.goal};
}

PathPhase::State PathPhase::Next(double t, const State& x, const TaskVector& e) const {
  State next = At(t, x);
  const double y = std::clamp((e.norm() - o_.free) / (o_.stop - o_.free), 0.0, 1.0);
  next.goal = 1 - y * y * (3 - 2 * y);
  return next;
}

PathTime PathPhase::Phase(double t, const State& x) const {
  const State now = At(t, x);
  return {t - now.deficit, now.rate, (now.goal - now.rate) / o_.lag_s, false};
}

}  // namespace pliant
