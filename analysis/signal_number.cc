#include "pliant/analysis/signal_number.h"

#include <algorithm>
#include <cmath>

#include "pliant/analysis/high_pass.h"
#include "pliant/analysis/series.h"
#include "pliant/analysis/with_unit.h"

namespace pliant {

namespace {

/// Two times that are as near as this are the same: of rows in nanoseconds and of numbers in a
/// file.
constexpr double kSameTime = 0.5e-9;

std::vector<Eigen::Index> RowsOf(const SignalNumber& number, const RecordedSignal& signal) {
  std::vector<Eigen::Index> rows;
  for (const std::string& element : number.elements) rows.push_back(signal.row(element));
  if (number.elements.empty())
    for (Eigen::Index i = 0; i < std::ssize(signal.elements); ++i) rows.push_back(i);
  Require(!rows.empty(), signal.path + " has no elements");
  return rows;
}

std::string UnitOf(const SignalNumber& number, const RecordedSignal& signal) {
  const std::vector<Eigen::Index> rows = RowsOf(number, signal);
  const std::string& unit = signal.units[static_cast<std::size_t>(rows.front())];
  for (const Eigen::Index row : rows)
    if (const std::string& other = signal.units[static_cast<std::size_t>(row)]; other != unit)
      throw Error("the elements of " + signal.path + " are in [" + unit + "] and in [" + other +
                  "]; name elements of one unit");
  return unit;
}

/// The time between rows of a log, all of which a filter needs.
Duration PeriodOf(const RecordedSignal& signal) {
  const Eigen::Index n = signal.times.size();
  if (n < 2) return 1ms;
  const double h = (signal.times(n - 1) - signal.times(0)) / static_cast<double>(n - 1);
  for (Eigen::Index k = 1; k < n; ++k)
    if (std::abs(signal.times(k) - signal.times(k - 1) - h) > 1e-3 * h)
      throw Error("the rows of " + signal.path + " are " +
                  WithUnit(signal.times(k) - signal.times(k - 1), "s") + " apart at " +
                  WithUnit(signal.times(k), "s") + ", elsewhere " + WithUnit(h, "s") +
                  "; above_hz and below_hz need rows that are evenly spaced");
  return Duration::Nanoseconds(std::llround(1e9 * h));
}

double SettlingTime(const SignalNumber& number, const Eigen::VectorXd& times, const Series& y) {
  Eigen::VectorXd at = Eigen::VectorXd::Zero(y.rows());
  if (number.settles_at == SettlesAt::Final) {
    const double tenth = times(times.size() - 1) - 0.1 * (times(times.size() - 1) - times(0));
    at = y.rightCols((times.array() >= tenth).count()).rowwise().mean();
  }
  const Eigen::VectorXd off = Norms(y.colwise() - at);
  // What is not a number is outside.
  Eigen::Index settled = off.size();
  while (settled > 0 && off(settled - 1) <= number.band) --settled;
  if (settled == off.size()) return kUnbounded;
  return settled == 0 ? 0 : times(settled) - number.from_s;
}

}  // namespace

void RequireEveryTick(const Scenario& scenario) {
  const Duration control = ControlPeriodOf(scenario), log = LogPeriodOf(scenario);
  Require(!(control < log), "log_period must be <= " + control.text() + ", the controller's period",
          log.text());
}

void RequireRowBetween(double from_s, double to_s, const Scenario& scenario) {
  Require(from_s <= to_s, "from_s must be <= to_s", Text(from_s) + " and " + Text(to_s));
  Require(from_s <= scenario.duration_s,
          "from_s must be <= duration_s, " + Text(scenario.duration_s), from_s);
  const double period = seconds(LogPeriodOf(scenario));
  Require(std::ceil(from_s / period - 1e-9) * period <= std::min(to_s, scenario.duration_s) + 1e-9,
          "no row of the log, one each " + LogPeriodOf(scenario).text() +
              ", lies between from_s and to_s",
          Text(from_s) + " and " + Text(to_s));
}

void SignalNumber::RequireFit(const Scenario& scenario) const {
  RequireRowBetween(from_s, to_s, scenario);
  const bool settles = statistic == Statistic::SettlingTime;
  Require(!settles || band > 0, "settling_time wants a band > 0, in the signal's unit", band);
  Require(settles || band == 0, "band is of settling_time only", band);
  Require(settles || settles_at == SettlesAt::Zero, "settles_at is of settling_time only");
  if (relative_to_s)
    Require(*relative_to_s <= scenario.duration_s,
            "relative_to_s must be <= duration_s, " + Text(scenario.duration_s), *relative_to_s);
  Require(!relative_to_s || above_hz == 0,
          "relative_to_s does not go with above_hz, which leaves no constant");
  const double most = 0.5 / seconds(LogPeriodOf(scenario));
  Require(above_hz < most,
          "above_hz must be < " + Text(most) + " Hz, half the rate of the log's rows", above_hz);
  Require(below_hz == kUnbounded || below_hz < most,
          "below_hz must be < " + Text(most) + " Hz, half the rate of the log's rows", below_hz);
  Require(above_hz < below_hz, "above_hz must be < below_hz",
          Text(above_hz) + " and " + Text(below_hz));
}

void SignalNumber::RequireSound(const RecordedSignal& recorded) const { UnitOf(*this, recorded); }

bool SignalNumber::is_norm(const RecordedSignal& recorded) const {
  return RowsOf(*this, recorded).size() > 1;
}

std::string SignalNumber::unit(const RecordedSignal& recorded) const {
  return statistic == Statistic::SettlingTime ? "s" : UnitOf(*this, recorded);
}

std::string SignalNumber::text(const RecordedSignal& recorded) const {
  std::string word = WordOf(statistic), what;
  std::ranges::replace(word, '_', ' ');
  for (const std::string& element : elements) what += (what.empty() ? "[" : ", ") + element;
  const bool settles = statistic == Statistic::SettlingTime;  // of a vector, not of its norm
  std::string text = word + (is_norm(recorded) && !settles ? " norm of " : " of ") + signal +
                     (what.empty() ? "" : what + "]");
  if (relative_to_s) text += " relative to " + WithUnit(*relative_to_s, "s");
  if (above_hz > 0) text += " above " + WithUnit(above_hz, "Hz");
  if (std::isfinite(below_hz)) text += " below " + WithUnit(below_hz, "Hz");
  if (settles)
    text += " to within " + WithUnit(band, UnitOf(*this, recorded)) + " of " +
            (settles_at == SettlesAt::Zero ? "zero" : "its final mean");
  if (from_s > 0) text += " from " + WithUnit(from_s, "s");
  if (std::isfinite(to_s)) text += " to " + WithUnit(to_s, "s");
  return text;
}

Eigen::MatrixXd SignalNumber::Elements(const RecordedSignal& recorded) const {
  Series all = recorded.numbers(RowsOf(*this, recorded), Eigen::all);
  if (above_hz > 0) all = HighPass(all, above_hz, PeriodOf(recorded));
  if (std::isfinite(below_hz)) all -= HighPass(all, below_hz, PeriodOf(recorded));
  if (relative_to_s) {
    // The row at that time, or the first after it.
    const Eigen::Index at =
        RowsBetween(recorded.times, *relative_to_s - kSameTime, kUnbounded).begin;
    Require(at < all.cols(), "no row of " + signal + " lies at or after relative_to_s",
            *relative_to_s);
    all.colwise() -= all.col(at).eval();
  }
  return all;
}

double SignalNumber::Of(const Recording& recording) const {
  const RecordedSignal& recorded = recording[signal];
  UnitOf(*this, recorded);
  const RowsBetween rows(recorded.times, from_s, to_s);
  Require(rows.size() > 0, "no row of " + signal + " lies between from_s and to_s",
          Text(from_s) + " and " + Text(to_s));
  const Series y = Elements(recorded).middleCols(rows.begin, rows.size());
  const Eigen::VectorXd x = y.rows() > 1 ? Norms(y) : Eigen::VectorXd(y.row(0).transpose());
  switch (statistic) {
    case Statistic::Peak:
      return Largest(x);
    case Statistic::Least:
      return -Largest(-x);
    case Statistic::Magnitude:
      return Largest(x.cwiseAbs());
    case Statistic::Rms:
      return std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
    case Statistic::Mean:
      return x.mean();
    case Statistic::Last:
      return x(x.size() - 1);
    case Statistic::Range:
      return Largest(x) + Largest(-x);
    case Statistic::SettlingTime:
      return SettlingTime(*this, recorded.times.segment(rows.begin, rows.size()), y);
  }
  return NAN;
}

}  // namespace pliant
