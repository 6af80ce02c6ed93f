#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/interval.h"
#include "pliant/analysis/report.h"
#include "pliant/analysis/run_data.h"
#include "pliant/analysis/signal_number.h"

namespace pliant {

/// A number of some runs, measured once in each repetition.
class RepeatedNumber {
 public:
  struct OfRun {
    std::string run, title;
    std::vector<double> values = {};  ///< in the order of the repetitions

    bool finite() const;
  };

  RepeatedNumber(SignalNumber number, std::vector<std::string> runs);

  /// Measures one repetition.
  void Add(const Runs& repetition);

  const std::string& text() const { return text_; }  ///< what the number is
  const std::string& unit() const { return unit_; }
  std::size_t repetitions() const { return runs_.front().values.size(); }
  const std::vector<OfRun>& runs() const { return runs_; }
  /// Of a run that it was measured of.
  const OfRun& operator[](std::string_view run) const;

 private:
  SignalNumber number_;
  std::string text_, unit_;
  std::vector<OfRun> runs_;
};

/// For each number and run the mean, the standard deviation s, where the mean of further
/// repetitions would lie (BCa bootstrap, 95 %), and the median.
Table NumbersTable(const std::vector<RepeatedNumber>& numbers);

/// "5.10 mm ± 0.300 mm": mean and standard deviation.
std::string MeanAndDeviation(const std::vector<double>& values, const std::string& unit);

/// "1.00 mm … 2.00 mm"
std::string IntervalText(const Interval& interval, const std::string& unit);

/// "p = 0.012", two digits; "p < 1e-300" of what is too small for a double.
std::string PText(double p);

/// BCa bootstrap, 95 %, of the difference of two means; none if nothing scatters.
std::optional<Interval> IntervalOfDifference(const std::vector<double>& first,
                                             const std::vector<double>& second);

/// Why numbers cannot be compared by statistics, if they cannot: some are not finite. What is said
/// is what was measured, so a claim does not hold.
std::optional<std::string> WhyNotComparable(const RepeatedNumber& numbers);

}  // namespace pliant
