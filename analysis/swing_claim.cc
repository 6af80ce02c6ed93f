#include "pliant/analysis/swing_claim.h"

#include <Eigen/QR>
#include <cmath>

#include "pliant/analysis/signal_number.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

/// ∫ from the first row on, by trapezoids.
Eigen::VectorXd Integral(const Eigen::VectorXd& t, const Eigen::VectorXd& x) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(x.size());
  for (Eigen::Index k = 1; k < x.size(); ++k)
    sum(k) = sum(k - 1) + 0.5 * (t(k) - t(k - 1)) * (x(k) + x(k - 1));
  return sum;
}

bool Near(double found, double expected, double part) {
  return std::abs(found - expected) <= part * expected;
}

}  // namespace

Swing FitSwing(const Eigen::VectorXd& times, const Eigen::VectorXd& x) {
  Require(x.size() >= 10, "a swing is fitted to at least 10 rows", x.size());
  const Eigen::VectorXd t = times.array() - times(0);
  const Eigen::VectorXd once = Integral(t, x), twice = Integral(t, once);
  Eigen::MatrixXd A(x.size(), 5);
  A << Eigen::VectorXd::Ones(x.size()), t, t.cwiseAbs2(), -once, -twice;
  const Eigen::VectorXd c = A.colPivHouseholderQr().solve(x);
  const double frequency = std::sqrt(c(4));
  return {frequency, c(3) / (2 * frequency)};
}

void SwingClaim::RequireFit(const Scenario& scenario) const {
  RequireRowBetween(from_s, to_s, scenario);
}

void SwingClaim::RequireSound(const Recording& recorded) const { recorded[signal].row(element); }

Claim SwingClaim::Check(const Runs& runs) const {
  const RecordedSignal& recorded = runs[run].log[signal];
  const RowsBetween rows(recorded.times, from_s, to_s);
  const Swing swing = FitSwing(
      recorded.times.segment(rows.begin, rows.size()),
      recorded.numbers.row(recorded.row(element)).segment(rows.begin, rows.size()).transpose());
  return claim.Stated(
      signal + "[" + element + "] swings with " + WithUnit(swing.frequency, "rad/s") +
          " and a damping ratio of " + WithUnit(swing.damping, ""),
      WithUnit(frequency, "rad/s") + " and " + WithUnit(damping, "") + ", each to " +
          Text(100 * within) + " %",
      basis, Near(swing.frequency, frequency, within) && Near(swing.damping, damping, within));
}

}  // namespace pliant
