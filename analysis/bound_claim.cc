#include "pliant/analysis/bound_claim.h"

#include <cmath>

#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

/// The rows of the named elements, or all.
Eigen::MatrixXd Picked(const RecordedSignal& signal, const std::vector<std::string>& elements) {
  if (elements.empty()) return signal.numbers;
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(elements.size()), signal.times.size());
  for (std::size_t i = 0; i < elements.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = signal[elements[i]].transpose();
  return rows;
}

double Of(Statistic statistic, const Eigen::VectorXd& x) {
  switch (statistic) {
    case Statistic::Peak:
      return x.maxCoeff<Eigen::PropagateNaN>();
    case Statistic::Rms:
      return std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
    case Statistic::Mean:
      return x.mean();
    case Statistic::Last:
      return x(x.size() - 1);
  }
  return NAN;
}

}  // namespace

void BoundClaim::RequireFit(const Scenario& scenario) const {
  Require(std::isfinite(least) || std::isfinite(most), "least or most must be given");
  Require(least <= most, "least must be <= most", Text(least) + " and " + Text(most));
  Require(from_s <= to_s, "from_s must be <= to_s", Text(from_s) + " and " + Text(to_s));
  Require(from_s <= scenario.duration_s,
          "from_s must be <= duration_s, " + Text(scenario.duration_s), from_s);
}

Claim BoundClaim::Check(const Runs& runs) const {
  const std::string where = "claim '" + claim.id + "': ";
  const RecordedSignal& recorded = runs[run].log[signal];
  const Eigen::VectorXd norm = Picked(recorded, elements).colwise().norm();
  const Eigen::Index begin = (recorded.times.array() < from_s).count();
  const Eigen::Index end = (recorded.times.array() <= to_s).count();
  Require(begin < end, where + "no row of " + signal + " lies between from_s and to_s",
          Text(from_s) + " and " + Text(to_s));
  const double value = Of(statistic, norm.segment(begin, end - begin));
  const std::string unit = recorded.units.empty() ? "" : recorded.units.front();
  std::string criterion;
  if (std::isfinite(least)) criterion = "at least " + WithUnit(least, unit);
  if (std::isfinite(most))
    criterion += (criterion.empty() ? "at most " : ", at most ") + WithUnit(most, unit);
  std::string what;
  for (const std::string& element : elements) what += (what.empty() ? "[" : ", ") + element;
  const std::string& word = Words(statistic)[static_cast<std::size_t>(statistic)];
  return {.id = claim.id,
          .source = claim.source,
          .paper = claim.paper,
          .measured = word + " of " + signal + (what.empty() ? "" : what + "]") + " is " +
                      WithUnit(value, unit),
          .criterion = criterion,
          .basis = basis,
          .holds = value >= least && value <= most};
}

}  // namespace pliant
