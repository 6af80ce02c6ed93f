#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/analysis/tunable_values.h"

namespace pliant::internal {

/// The tunable values of a run as parameters of a protocol: named by their paths, with the values
/// that were set last. A number is a number, a flag true or false, a word a string, and several
/// numbers are an array, those of a matrix column by column.
class LiveParameters {
 public:
  using Json = nlohmann::json;

  explicit LiveParameters(std::vector<TunableValue> tunables);

  std::size_t size() const { return tunables_.size(); }
  const TunableValue& operator[](std::size_t i) const { return tunables_[i]; }
  std::span<const double> numbers(std::size_t i) const { return numbers_[i]; }

  /// The parameter's place; throws Error with the nearest name if there is none.
  std::size_t Find(std::string_view name) const;

  Json Value(std::size_t i) const;
  /// The numbers of a value that is to be set; throws Error with what was expected.
  std::vector<double> Read(std::size_t i, const Json& value) const;
  void Set(std::size_t i, std::vector<double> numbers) { numbers_[i] = std::move(numbers); }

  /// What a page must know to show them, with the values at the start.
  Json Description() const;

 private:
  Json ValueOf(std::size_t i, std::span<const double> numbers) const;

  const std::vector<TunableValue> tunables_;
  std::vector<std::vector<double>> numbers_;
  std::map<std::string, std::size_t, std::less<>> by_name_;
};

}  // namespace pliant::internal
