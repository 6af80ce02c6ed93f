#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/record_sink.h"

namespace pliant {

/// A value over time.
struct RecordedSignal : RecordedValue {
  Eigen::VectorXd times;    ///< [s]
  Eigen::MatrixXd numbers;  ///< a column for each time, a row for each element

  /// The index of an element, by its name with or without brackets and dot; throws Error with the
  /// nearest name if there is none.
  Eigen::Index row(std::string_view element) const;
  /// Its numbers.
  Eigen::VectorXd operator[](std::string_view element) const { return numbers.row(row(element)); }
};

/// What a run has recorded, in memory:
///
///   const Recording run = Recording::Read("run.mcap");
///   run["pose.error"].numbers.bottomRows<3>().colwise().norm().maxCoeff();
///
class Recording {
 public:
  /// Maps of words by the name of the record, such as "pliant": {"version": …, "scenario": …}.
  using Metadata = std::map<std::string, std::map<std::string, std::string>>;

  Recording() = default;
  Recording(std::vector<RecordedSignal> signals, Metadata metadata,
            std::string robot_description = {});

  /// A log written by McapLog, a signal's rows in order of time. Throws Error with the file and the
  /// place in it.
  static Recording Read(const std::filesystem::path& file);

  const std::vector<RecordedSignal>& signals() const { return signals_; }
  const Metadata& metadata() const { return metadata_; }
  /// URDF; empty if the log has none.
  const std::string& robot_description() const { return robot_description_; }
  bool has(std::string_view path) const;
  /// Throws Error with the nearest path if there is none.
  const RecordedSignal& operator[](std::string_view path) const;

 private:
  std::vector<RecordedSignal> signals_;
  Metadata metadata_;
  std::string robot_description_;
};

}  // namespace pliant
