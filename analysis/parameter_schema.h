#pragma once

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "pliant/plants/parameter_file.h"

namespace pliant::internal {

using Json = nlohmann::ordered_json;

template <HasParameters T>
Json SchemaOfStruct();

inline Json SchemaOfNumber(const char* type, std::string_view unit, const Range& range) {
  Json number{{"type", type}};
  if (range.least > kAnyNumber.least)
    number[range.without_least ? "exclusiveMinimum" : "minimum"] = range.least;
  if (range.most < kAnyNumber.most)
    number[range.without_most ? "exclusiveMaximum" : "maximum"] = range.most;
  // A number with its unit behind it, or a word such as .inf.
  Json word{{"type", "string"}, {"pattern", unit.empty() ? "^[-+]?\\.inf$" : "^[-+.0-9]"}};
  Json schema{{"anyOf", Json::array({number, word})}};
  if (!unit.empty()) schema["description"] = "[" + std::string(unit) + "]";
  return schema;
}

/// The JSON Schema of a parameter: what ParameterFile::Read takes for it.
template <class T>
Json SchemaOf(std::string_view unit, const Range& range) {
  if constexpr (std::is_same_v<T, Overrides>) {
    return {{"type", "object"}};
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    return SchemaOfNumber("integer", unit, range);
  } else if constexpr (std::is_floating_point_v<T>) {
    return SchemaOfNumber("number", unit, range);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return {{"type", "string"}, {"minLength", 1}};
  } else if constexpr (std::is_same_v<T, Duration>) {
    return {{"type", "string"}, {"description", "a time such as 1 ms or a rate such as 30 Hz"}};
  } else if constexpr (HasWords<T>) {
    Json words = Words(T{});
    // YAML without quotes takes this word for a flag.
    if (std::ranges::count(Words(T{}), "true") > 0) words.push_back(true);
    return {{"enum", words}};
  } else if constexpr (Dense<T>) {
    const Json number = SchemaOfNumber("number", unit, range);
    const Json row{{"type", "array"}, {"items", number}};
    if constexpr (IsOfAnySize<T>)
      return {{"anyOf", Json::array({number, row, Json{{"type", "array"}, {"items", row}},
                                     Json{{"type", "null"}}})}};
    Json list{{"type", "array"}, {"items", T::ColsAtCompileTime == 1 ? number : row}};
    if constexpr (T::RowsAtCompileTime != Eigen::Dynamic)
      list["minItems"] = list["maxItems"] = int{T::RowsAtCompileTime};
    return list;
  } else if constexpr (IsOptional<T>) {
    return {{"anyOf",
             Json::array({SchemaOf<typename T::value_type>(unit, range), Json{{"type", "null"}}})}};
  } else if constexpr (IsList<T>) {
    return {{"type", Json::array({"array", "null"})},
            {"items", SchemaOf<typename T::value_type>(unit, range)}};
  } else if constexpr (IsVariant<T>) {
    return []<class... A>(const std::variant<A...>*) {
      Json all = Json::array();
      const auto add = [&]<class Alternative>(const Alternative*) {
        Json one = SchemaOfStruct<Alternative>();
        one["title"] = "!" + std::string(Alternative::kTag);
        all.push_back(std::move(one));
      };
      (add(static_cast<const A*>(nullptr)), ...);
      return Json{{"anyOf", all}};
    }(static_cast<const T*>(nullptr));
  } else {
    return SchemaOfStruct<T>();
  }
}

template <HasParameters T>
Json SchemaOfStruct() {
  Json properties = Json::object(), required = Json::array();
  const auto t = std::make_unique<T>();
  t->Parameters([&](std::string_view name, auto& value, std::string_view unit = {},
                    const Range& range = kAnyNumber) {
    properties[std::string(name)] = SchemaOf<std::decay_t<decltype(value)>>(unit, range);
    if (IsToBeGiven(value)) required.push_back(std::string(name));
  });
  Json schema{{"type", Json::array({"object", "null"})},
              {"properties", properties},
              {"additionalProperties", false}};
  if (!required.empty()) {
    schema["type"] = "object";
    schema["required"] = required;
  }
  return schema;
}

}  // namespace pliant::internal
