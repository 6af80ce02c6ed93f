#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/run_data.h"

namespace pliant::internal {

/// The page, with a drawing for each of the report's figures, and with its runs. Less than 5 MB
/// where the figures allow it.
std::string ReportPage(const Report& report, const std::vector<std::string>& drawings,
                       const Runs& runs);

}  // namespace pliant::internal
