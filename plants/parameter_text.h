#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "pliant/plants/parameter_file.h"

namespace pliant {

namespace internal {

/// Of numbers and words, as ParameterFile reads them back exactly.
std::string YamlText(double value);
std::string YamlText(bool value);
std::string YamlText(const std::string& word);
std::string YamlText(const Duration& duration);

template <class Number>
requires std::is_integral_v<Number> std::string YamlText(Number value) {
  return std::to_string(value);
}

/// A value in one line, where it has one.
template <class T>
std::string LineOf(const T& value) {
  if constexpr (HasWords<T>) {
    return WordOf(value);
  } else if constexpr (Dense<T>) {
    if (IsOfAnySize<T> && value.size() == 1) return YamlText(value(0, 0));
    const bool column = T::ColsAtCompileTime == 1 || (IsOfAnySize<T> && value.cols() == 1);
    std::string rows;
    for (Eigen::Index r = 0; r < value.rows(); ++r) {
      std::string row;
      for (Eigen::Index c = 0; c < value.cols(); ++c)
        row += (c == 0 ? "" : ", ") + YamlText(value(r, c));
      rows += (r == 0 ? "" : ", ") + (column ? row : "[" + row + "]");
    }
    return "[" + rows + "]";
  } else if constexpr (IsOptional<T>) {
    return value ? LineOf(*value) : "~";
  } else {
    return YamlText(value);
  }
}

template <class T>
constexpr bool IsBlock = HasParameters<T> || IsList<T> || IsVariant<T>;
template <class T>
constexpr bool IsBlock<std::optional<T>> = IsBlock<T>;

template <class T>
std::string EntriesOf(const T& t, const std::string& indent);

/// What stands behind "key:" or "-".
template <class T>
std::string ValueOf(const T& value, const std::string& indent) {
  if constexpr (std::is_same_v<T, Overrides>) {
    std::string all;
    for (const auto& [path, yaml] : value) all += "\n" + indent + YamlText(path) + ": " + yaml;
    return all.empty() ? " {}" : all;
  } else if constexpr (!IsBlock<T>) {
    return " " + LineOf(value);
  } else if constexpr (IsOptional<T>) {
    return value ? ValueOf(*value, indent) : " ~";
  } else if constexpr (IsList<T>) {
    std::string all;
    for (const auto& element : value) all += "\n" + indent + "-" + ValueOf(element, indent + "  ");
    return all.empty() ? " []" : all;
  } else if constexpr (IsVariant<T>) {
    return std::visit(
        [&](const auto& of) { return " !" + std::string(of.kTag) + ValueOf(of, indent); }, value);
  } else {
    const std::string entries = EntriesOf(value, indent);
    return entries.empty() ? " {}" : entries;
  }
}

template <class T>
std::string EntriesOf(const T& t, const std::string& indent) {
  std::string all;
  const_cast<T&>(t).Parameters([&](std::string_view name, const auto& value, std::string_view = {},
                                   const Range& = kAnyNumber) {
    all += "\n" + indent + std::string(name) + ":" + ValueOf(value, indent + "  ");
  });
  return all;
}

}  // namespace internal

/// The parameters as YAML that ParameterFile reads back exactly.
template <HasParameters T>
std::string ParametersText(const T& t) {
  return internal::EntriesOf(t, "").substr(1) + "\n";
}

}  // namespace pliant
