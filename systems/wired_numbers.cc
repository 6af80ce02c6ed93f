#include "pliant/systems/wired_numbers.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace pliant::internal {

WiredNumbers::WiredNumbers(const std::vector<Source>& sources) {
  for (const Source& source : sources) {
    if (!source.type->write)
      throw Error("cannot log " + source.path + " : " + source.type->name +
                  ", which is not made of numbers\ngive its type a function template Fields");
    std::vector<Column> columns;
    source.type->columns(source.initial, source.space, columns);
    if (columns.empty())
      throw Error("cannot log " + source.path + " : " + source.type->name +
                  ", which has no elements yet\ngive its port a space or an initial value");
    RecordedValue value{
        .path = source.path, .type = source.type->name, .elements = {}, .units = {}};
    for (Column& column : columns) {
      value.elements.push_back(std::move(column.name));
      value.units.push_back(std::move(column.unit));
    }
    widths_.push_back(columns.size());
    size_ += columns.size();
    values_.push_back(std::move(value));
  }
}

void WiredNumbers::Store(const AnyValues& values, std::span<double> row) const {
  double* to = row.data();
  for (int i = 0; i < values.size(); ++i) {
    const std::size_t n = widths_[static_cast<std::size_t>(i)];
    if (!values.type(i).store(values[i], to, n))
      std::fill_n(to, n, std::numeric_limits<double>::quiet_NaN());
    to += n;
  }
}

}  // namespace pliant::internal
