#include "pliant/analysis/tunable_values.h"

#include <algorithm>
#include <optional>
namespace pliant {

namespace {

using internal::Access;

/// Rows and columns of a matrix, from the name of its last element, such as "[5,5]".
void SetShape(TunableValue& tunable, const std::string& last) {
  const std::size_t comma = last.find(',');
  tunable.rows = 1 + std::stoi(last.substr(1));
  tunable.cols = 1 + std::stoi(last.substr(comma + 1));
}

std::optional<TunableValue> TunableOf(const internal::Slot& slot) {
  if (slot.role != internal::Role::Free || !slot.value || !slot.type->write) return {};
  const auto& declared = Access::Of(*slot.value);
  std::vector<internal::Column> columns;
  slot.type->columns(slot.initial, declared.space, columns);
  if (columns.empty()) return {};
  const std::string& last = columns.back().name;
  if (last.find('.') != last.npos || std::ranges::count(last, '[') > 1) return {};

  using Kind = TunableValue::Kind;
  TunableValue tunable;
  tunable.path = slot.value->path();
  tunable.type = slot.type->name;
  tunable.value = slot.value;
  slot.type->numbers(slot.initial, tunable.start);
  for (const internal::Column& column : columns) {
    tunable.elements.push_back(column.name);
    tunable.units.push_back(column.unit);
  }
  if (slot.type->words) {
    tunable.kind = Kind::Word;
    tunable.words = slot.type->words();
  } else if (slot.type == internal::TypeOf<bool>()) {
    tunable.kind = Kind::Flag;
  } else if (last.find(',') != last.npos) {
    tunable.kind = Kind::Matrix;
    SetShape(tunable, last);
  } else if (!last.empty()) {
    tunable.kind = Kind::Numbers;
  } else {
    tunable.whole = slot.type != internal::TypeOf<double>();
  }
  return tunable;
}

}  // namespace

std::vector<TunableValue> TunableValuesOf(const Diagram& diagram) {
  std::vector<TunableValue> all;
  for (const internal::Slot& slot : diagram.plan().slots)
    if (std::optional<TunableValue> tunable = TunableOf(slot)) all.push_back(std::move(*tunable));
  return all;
}

}  // namespace pliant
