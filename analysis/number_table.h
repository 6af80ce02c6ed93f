#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/analysis/repeated_number.h"

namespace pliant {

/// Numbers of some runs beside what a paper has: a row for each number, a column for each run. Of
/// several repetitions a cell has mean ± standard deviation.
struct NumberTable {
  struct Row {
    std::string title;
    SignalNumber number = {};
    double factor = 1;                     ///< that it is shown in, such as 100 for per cent
    std::optional<std::string> unit = {};  ///< that it has then; none: its own, scaled
    int digits = 3;                        ///< that are significant
    std::vector<std::string> paper =
        {};  ///< what the paper has for each of the runs; none: nothing

    template <class F>
    void Parameters(F&& f) {
      f("title", title);
      number.Parameters(f);
      f("factor", factor, "", kPositive);
      f("unit", unit);
      f("digits", digits, "", Between(1, 15));
      f("paper", paper);
    }
  };

  std::string title, caption;
  std::vector<std::string> runs = {};
  std::vector<Row> rows = {};

  template <class F>
  void Parameters(F&& f) {
    f("title", title);
    f("caption", caption);
    f("runs", runs);
    f("rows", rows);
  }
  /// Throws Error without a title or a row, if `paper` has not one for each run, a factor has no
  /// unit, and where a number does.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const Recording& recorded) const;
  std::vector<RepeatedNumber> Wanted() const;
  Table Show(const std::vector<RepeatedNumber>& measured) const;
};

}  // namespace pliant
