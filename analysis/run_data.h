#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/recording.h"
#include "pliant/analysis/report.h"
#include "pliant/diagrams/scenario.h"

namespace pliant {

/// What the log of a run says of it, without its rows.
struct RunHeading {
  std::filesystem::path file;
  std::string name;        ///< of the run in its experiment
  std::string title;       ///< for tables and figures
  int repetition = 0;      ///< from 0
  std::string experiment;  ///< the effective file, as YAML
  std::string version;     ///< of pliant
  std::string built_with;  ///< compiler and libraries that results may depend on
  Timing timing = {};
  bool whole = true;       ///< it reached its end, or a block of it ended it
  std::string ended;       ///< by which block, when and why; empty: none did
  std::string integrator;  ///< what it did, in words

  /// Throws Error with the file if it is no log of a run.
  static RunHeading Read(const std::filesystem::path& file);
};

/// What one run was and what it left: read from its log alone.
struct RunData : RunHeading {
  Scenario scenario = {};
  SimulatedArm::Options arm = {};
  ArmController control = {};
  Recording log = {};

  /// Throws Error with the file if it is no log of a run.
  static RunData Read(const std::filesystem::path& file);

  const Eigen::VectorXd& times() const;  ///< of the rows of the log [s]
  Duration sample_period() const { return scenario.log_period.value_or(PeriodOf(control)); }
  /// A column for each of `times`, a row for each element.
  const Eigen::MatrixXd& operator[](std::string_view path) const { return log[path].numbers; }
};

/// One repetition of the runs of an experiment, by name.
class Runs {
 public:
  Runs() = default;
  explicit Runs(std::vector<const RunData*> runs) : runs_{std::move(runs)} {}

  /// Throws Error with the nearest name if there is none.
  const RunData& operator[](std::string_view name) const;
  const std::vector<const RunData*>& all() const { return runs_; }

 private:
  std::vector<const RunData*> runs_;
};

}  // namespace pliant
