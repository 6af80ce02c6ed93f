#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pliant/analysis/progress.h"
#include "pliant/analysis/report.h"

namespace pliant {

/// What is found out by a program of its own rather than from the log of an arm.
struct Study {
  std::string name;
  std::string summary;
  std::function<Report(const Progress&)> run;
};

const std::vector<Study>& Studies();

}  // namespace pliant
