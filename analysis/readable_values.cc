#include "pliant/analysis/readable_values.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

namespace pliant {

std::vector<ReadableValue> ReadableValuesOf(const Diagram& diagram) {
  using internal::Access;
  std::map<std::uint32_t, const void*> initial;
  for (const internal::Slot& slot : diagram.plan().slots) initial[slot.offset] = slot.initial;
  const std::vector<TunableValue> tunables = TunableValuesOf(diagram);
  const std::vector<ValueInfo> infos = diagram.Values();
  auto info = infos.begin();
  std::vector<ReadableValue> all;
  for (const Block* block : diagram.plan().blocks)
    for (const auto& declared : Access::Values(*block)) {
      const ValueInfo& of = *info++;
      if (declared.kind == internal::Kind::InputList || declared.kind == internal::Kind::Scratch ||
          !declared.type || !declared.type->write)
        continue;
      ReadableValue value;
      const auto tunable = std::ranges::find(tunables, of.path, &TunableValue::path);
      if (tunable != tunables.end()) {
        static_cast<TunableValue&>(value) = *tunable;
        value.tunable = true;
      } else {
        value.path = of.path;
        value.type = declared.type->name;
        value.value = declared.value;
        std::vector<internal::Column> columns;
        const void* const start = initial.at(Access::Offset(*declared.value));
        declared.type->columns(start, declared.space, columns);
        declared.type->numbers(start, value.start);
        for (const internal::Column& column : columns) {
          value.elements.push_back(column.name);
          value.units.push_back(column.unit);
        }
        const bool plain = columns.size() == 1 && columns[0].name.empty();
        value.kind = !plain                                      ? TunableValue::Kind::Numbers
                     : declared.type->words                      ? TunableValue::Kind::Word
                     : declared.type == internal::TypeOf<bool>() ? TunableValue::Kind::Flag
                                                                 : TunableValue::Kind::Number;
        if (declared.type->words) value.words = declared.type->words();
      }
      value.role = of.kind;
      all.push_back(std::move(value));
    }
  return all;
}

}  // namespace pliant
