#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/run_data.h"

namespace pliant::internal {

/// What a page holds of its runs besides the report: their signals to zoom into, and the robot over
/// time. HTML for the middle of the body, and for its end; web/README.md says what is in it. Long
/// runs are thinned out until all of them fit `characters`.
struct ReplaySection {
  std::string middle, end;
};
ReplaySection ReplaySectionOf(const std::vector<const RunData*>& runs, std::size_t characters);

}  // namespace pliant::internal
