#pragma once

#include <string>
#include <vector>

#include "pliant/analysis/report.h"

namespace pliant::internal {

/// The page, with a drawing for each of the report's figures in it.
std::string ReportPage(const Report& report, const std::vector<std::string>& drawings);

}  // namespace pliant::internal
