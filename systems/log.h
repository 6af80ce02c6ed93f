#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/wired_numbers.h"

namespace pliant {

/// Numbers over time, a row for each instant and a column for each number:
///
///   const Log& log = sim.Get(logger.log);
///   log["arm.velocity[elbow]"].maxCoeff();
///
/// A column is named path.port[element] (unit); it is found with its unit or without.
class Log {
 public:
  /// The numbers of a column in order of time; valid until the log changes.
  using Column = Eigen::Map<const Eigen::VectorXd, Eigen::Unaligned, Eigen::InnerStride<>>;

  Log() = default;
  /// Columns for the values of `sources`; `capacity` rows fit without allocation.
  Log(const std::vector<internal::Source>& sources, std::size_t capacity);
  /// A copy has room for as many rows.
  Log(const Log& other);
  Log& operator=(const Log& other);

  std::size_t rows() const { return cells_.size() / width(); }
  const std::vector<std::string>& columns() const { return names_; }

  Column times() const { return At(0); }  ///< [s]
  /// Throws Error with the nearest name if there is no such column.
  Column operator[](std::string_view column) const;

  /// A row of times and columns per instant, under a row of names. Numbers are written so that they
  /// are read back exactly. A failed write leaves an older file as it was.
  void WriteCsv(const std::filesystem::path& file) const;

  /// Adds a row. Rows at t and later, from a run that was restored to an earlier time, make room.
  /// The numbers of a value that has changed its shape are NaN.
  void Record(double t, const AnyValues& values);

 private:
  std::size_t width() const { return names_.size() + 1; }
  Column At(std::size_t column) const;

  std::vector<std::string> names_;
  internal::WiredNumbers numbers_;
  std::vector<double> cells_;  // row by row, the time first
  std::size_t capacity_ = 0;   // rows
};

}  // namespace pliant
