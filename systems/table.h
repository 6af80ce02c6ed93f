#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "pliant/systems/block.h"
#include "pliant/systems/nearest_name.h"
#include "pliant/systems/time_table.h"

namespace pliant {

/// Plays back a table of numbers over time: linear between rows, constant before the first and
/// after the last.
///
///   b.Add<Table<JointTorque>>("torque", {.space = joints, .table = ReadTimeTable("torque.csv")});
template <class S>
class Table final : public Block {
 public:
  using Space = typename internal::SpaceOf<S>::type;
  struct Options {
    Space space = {};
    TimeTable table;
    std::vector<std::string> columns = {};  ///< one per element, by name; none: all there are
  };

  explicit Table(const Options& o) : y{this, "y", o.space}, times_{o.table.times}, rows_{Rows(o)} {
    Compute(y).From(clock).As(&Table::At);
  }

  Output<S> y;

 private:
  static std::vector<S> Rows(const Options& o) {
    const TimeTable& table = o.table;
    const std::vector<std::string>& names = o.columns.empty() ? table.columns : o.columns;
    S row = internal::ZeroOf<S>(o.space);
    const std::size_t elements = internal::Count(row);
    Require(!table.times.empty(), "table must have a row");
    Require(names.size() == elements,
            "columns must be as many as the signal has elements, " + Text(elements), names.size());
    std::vector<std::size_t> picked;
    for (const std::string& name : names) {
      const auto at = std::ranges::find(table.columns, name);
      if (at == table.columns.end())
        throw Error("the table has no column '" + name + "'" + DidYouMean(name, table.columns));
      picked.push_back(static_cast<std::size_t>(at - table.columns.begin()));
    }
    std::vector<S> rows;
    std::vector<double> numbers(elements);
    for (std::size_t r = 0; r < table.times.size(); ++r) {
      std::ranges::transform(picked, numbers.begin(), [&](std::size_t column) {
        return table.cells[r * table.columns.size() + column];
      });
      internal::SetNumbers(row, numbers.data());
      rows.push_back(row);
    }
    return rows;
  }

  S At(double t) const {
    const auto after = std::ranges::upper_bound(times_, t);
    if (after == times_.begin()) return rows_.front();
    if (after == times_.end()) return rows_.back();
    const auto i = static_cast<std::size_t>(after - times_.begin());
    const double part = (t - times_[i - 1]) / (times_[i] - times_[i - 1]);
    return rows_[i - 1] + part * (rows_[i] - rows_[i - 1]);
  }

  const std::vector<double> times_;
  const std::vector<S> rows_;
};

}  // namespace pliant
