#include "pliant/analysis/smooth_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <span>

#include "pliant/systems/error.h"

namespace pliant {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The samples of one file that are no stale repetition: their columns.
std::vector<Index> Fresh(const Samples& x, Index from, Index to, double repeat_s) {
  const auto same = [&](Index a, Index b) {
    return x.position.col(a) == x.position.col(b) && x.velocity.col(a) == x.velocity.col(b) &&
           x.torque.col(a) == x.torque.col(b);
  };
  std::vector<Index> fresh;
  for (Index k = from; k < to;) {
    // [k, end) repeats row k.
    Index end = k + 1;
    while (end < to && same(k, end)) ++end;
    const bool rests = x.time[end - 1] - x.time[k] >= repeat_s;
    for (const Index keep = rests ? end : k + 1; k < keep; ++k)
      if (fresh.empty() || x.time[k] > x.time[fresh.back()]) fresh.push_back(k);
    k = end;
  }
  return fresh;
}

bool Surrounded(const Samples& x, std::span<const Index> window, double t, double h) {
  if (window.size() < 6) return false;
  const auto third = static_cast<std::ptrdiff_t>((window.size() + 2) / 3);
  const std::ptrdiff_t before =
      std::ranges::count_if(window, [&](Index k) { return x.time[k] < t; });
  if (before < third || std::ssize(window) - before < third) return false;
  for (std::size_t i = 1; i < window.size(); ++i)
    if (x.time[window[i]] - x.time[window[i - 1]] > h) return false;
  return true;
}

/// The median time from row to row.
double PeriodOf(const Samples& x, Index from, Index to) {
  std::vector<double> steps;
  for (Index k = from + 1; k < to; ++k) steps.push_back(x.time[k] - x.time[k - 1]);
  if (steps.empty()) return 0;
  const auto middle = steps.begin() + std::ssize(steps) / 2;
  std::ranges::nth_element(steps, middle);
  return *middle;
}

}  // namespace

SmoothMotion Smooth(const Samples& x, const SmoothingOptions& o) {
  Require(o.window_s > 0, "the window must be > 0 s", o.window_s);
  Require(o.step_s > 0, "the step must be > 0 s", o.step_s);
  const double h = 0.5 * o.window_s;
  const Index n = x.position.rows(), rows = 4 * n;
  SmoothMotion motion;
  std::vector<double> times;
  std::vector<double> numbers;  // of a point: q, v, v̇, τ
  for (std::size_t file = 0; file < x.begin.size(); ++file) {
    motion.begin.push_back(static_cast<Index>(times.size()));
    const Index to = file + 1 < x.begin.size() ? x.begin[file + 1] : x.time.size();
    const std::vector<Index> fresh = Fresh(x, x.begin[file], to, o.repeat_s);
    motion.repeated += to - x.begin[file] - std::ssize(fresh);
    if (fresh.empty()) continue;
    // Stamps are not exact. Where a window has no six rows there are no points, too many or not.
    const double period = PeriodOf(x, x.begin[file], to);
    Require(o.step_s > 0.99 * period || 5 * period > o.window_s,
            "the step must be >= the time from row to row, " + Text(period) +
                " s: points between rows say nothing new",
            o.step_s);
    const double start = x.time[fresh.front()] + h;
    auto first = fresh.begin(), last = fresh.begin();
    for (Index i = 0;; ++i) {
      const double t = start + static_cast<double>(i) * o.step_s;
      if (t + h > x.time[fresh.back()]) break;
      while (x.time[*first] < t - h) ++first;
      while (last != fresh.end() && x.time[*last] <= t + h) ++last;
      if (!Surrounded(x, {first, last}, t, h)) {
        ++motion.gaps;
        continue;
      }
      Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
      MatrixXd b = MatrixXd::Zero(4, 3 * n);
      for (auto k = first; k != last; ++k) {
        const double s = (x.time[*k] - t) / h;
        const Eigen::Vector4d powers(1, s, s * s, s * s * s);
        A += powers * powers.transpose();
        b.leftCols(n) += powers * x.position.col(*k).transpose();
        b.middleCols(n, n) += powers * x.velocity.col(*k).transpose();
        b.rightCols(n) += powers * x.torque.col(*k).transpose();
      }
      const MatrixXd c = A.ldlt().solve(b);
      times.push_back(t);
      for (Index j = 0; j < 2 * n; ++j) numbers.push_back(c(0, j));
      for (Index j = n; j < 2 * n; ++j) numbers.push_back(c(1, j) / h);
      for (Index j = 2 * n; j < 3 * n; ++j) numbers.push_back(c(0, j));
    }
  }
  const Index points = static_cast<Index>(times.size());
  if (points == 0)
    throw Error("too few samples: no window of " + Text(o.window_s) + " s has six of them (" +
                Text(x.time.size()) + " rows, " + Text(motion.repeated) +
                " repeat the one before); give a wider window or a log at a higher rate");
  motion.time = Eigen::Map<const Eigen::VectorXd>(times.data(), points);
  const Eigen::Map<const MatrixXd> all(numbers.data(), rows, points);
  motion.position = all.topRows(n);
  motion.velocity = all.middleRows(n, n);
  motion.acceleration = all.middleRows(2 * n, n);
  motion.torque = all.bottomRows(n);
  return motion;
}

}  // namespace pliant
