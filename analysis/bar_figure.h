#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/figure.h"
#include "pliant/analysis/repeated_number.h"

namespace pliant {

/// EC-fig5: a panel for each number, in it a bar for each run: mean ± standard deviation over all
/// repetitions. Brackets say how two runs differ by a two-sided Mann–Whitney U test:
/// ** p < 0.001, * p < 0.05, n.s. otherwise; none if a number is not finite.
struct BarFigure {
  static constexpr const char* kTag = "Bars";

  struct Shown {
    std::string title;  ///< of the panel
    SignalNumber number = {};

    template <class F>
    void Parameters(F&& f) {
      f("title", title);
      number.Parameters(f);
    }
  };

  std::string name, caption;
  std::vector<std::string> runs = {};
  std::vector<Shown> numbers = {};
  bool brackets = true;

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("caption", caption);
    f("runs", runs);
    f("numbers", numbers);
    f("brackets", brackets);
  }
  std::string file() const { return name; }
  /// Throws Error if its name cannot name a file, without a number, and where a number does.
  void RequireFit(const Scenario& scenario) const;
  void RequireSound(const Recording& recorded) const;
  std::vector<RepeatedNumber> Wanted() const;
  Figure Draw(const std::vector<RepeatedNumber>& measured) const;
};

}  // namespace pliant
