#pragma once

#include <string>

#include "pliant/analysis/report.h"

namespace pliant {

/// Who claims what, and where it stands.
struct ClaimSource {
  std::string id;      ///< unique in its experiment
  std::string source;  ///< the paper and the place in it
  std::string paper;   ///< what it says

  template <class F>
  void Parameters(F&& f) {
    f("id", id);
    f("source", source);
    f("paper", paper);
  }

  /// The claim as it is stated in all three places: file, report, verdict.
  Claim Stated(std::string measured, std::string criterion, std::string basis, bool holds) const {
    return {.id = id,
            .source = source,
            .paper = paper,
            .measured = std::move(measured),
            .criterion = std::move(criterion),
            .basis = std::move(basis),
            .holds = holds};
  }
};

}  // namespace pliant
