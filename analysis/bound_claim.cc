#include "pliant/analysis/bound_claim.h"

#include <algorithm>
#include <cmath>

#include "pliant/analysis/series.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

/// Some elements of a signal, and the unit they share.
struct Picked {
  Picked(const RecordedSignal& signal, const std::vector<std::string>& elements) {
    std::vector<Eigen::Index> rows;
    for (const std::string& element : elements) rows.push_back(signal.row(element));
    if (elements.empty())
      for (Eigen::Index i = 0; i < std::ssize(signal.elements); ++i) rows.push_back(i);
    Require(!rows.empty(), signal.path + " has no elements");
    unit = signal.units[static_cast<std::size_t>(rows.front())];
    for (const Eigen::Index row : rows)
      if (const std::string& other = signal.units[static_cast<std::size_t>(row)]; other != unit)
        throw Error("the elements of " + signal.path + " are in [" + unit + "] and in [" + other +
                    "]; name elements of one unit");
    const Series numbers = signal.numbers(rows, Eigen::all);
    is_norm = rows.size() > 1;
    x = is_norm ? Norms(numbers) : Eigen::VectorXd(numbers.row(0).transpose());
  }

  Eigen::VectorXd x;
  bool is_norm;
  std::string unit;
};

double Of(Statistic statistic, const Eigen::VectorXd& x) {
  switch (statistic) {
    case Statistic::Peak:
      return Largest(x);
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
  const double period = seconds(LogPeriodOf(scenario));
  Require(std::ceil(from_s / period - 1e-9) * period <= std::min(to_s, scenario.duration_s) + 1e-9,
          "no row of the log, one each " + LogPeriodOf(scenario).text() +
              ", lies between from_s and to_s",
          Text(from_s) + " and " + Text(to_s));
}

void BoundClaim::RequireSound(const RecordedSignal& recorded) const {
  const Picked picked(recorded, elements);
  Require(!picked.is_norm || most >= 0, "most of a norm must be >= 0", most);
}

Claim BoundClaim::Check(const Runs& runs) const {
  const RecordedSignal& recorded = runs[run].log[signal];
  const Picked picked(recorded, elements);
  const Eigen::Index begin = (recorded.times.array() < from_s).count();
  const Eigen::Index end = (recorded.times.array() <= to_s).count();
  Require(begin < end,
          "claim '" + claim.id + "': no row of " + signal + " lies between from_s and to_s",
          Text(from_s) + " and " + Text(to_s));
  const double value = Of(statistic, picked.x.segment(begin, end - begin));
  std::string criterion;
  if (std::isfinite(least)) criterion = "at least " + WithUnit(least, picked.unit);
  if (std::isfinite(most))
    criterion += (criterion.empty() ? "at most " : ", at most ") + WithUnit(most, picked.unit);
  std::string what;
  for (const std::string& element : elements) what += (what.empty() ? "[" : ", ") + element;
  const std::string& word = Words(statistic)[static_cast<std::size_t>(statistic)];
  return {.id = claim.id,
          .source = claim.source,
          .paper = claim.paper,
          .measured = word + (picked.is_norm ? " norm of " : " of ") + signal +
                      (what.empty() ? "" : what + "]") + " is " + WithUnit(value, picked.unit),
          .criterion = criterion,
          .basis = basis,
          .holds = value >= least && value <= most};
}

}  // namespace pliant
