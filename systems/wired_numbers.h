#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/systems/record_sink.h"
#include "pliant/systems/value.h"

namespace pliant::internal {

/// The numbers of the values wired to AnyInputs, one after the other, as logs and recorders keep
/// them.
class WiredNumbers {
 public:
  WiredNumbers() = default;
  /// Throws Error for a value that is not made of numbers.
  explicit WiredNumbers(const std::vector<Source>& sources);

  const std::vector<RecordedValue>& values() const { return values_; }
  std::size_t size() const { return size_; }

  /// Fills `row`, which has `size()` numbers; those of a value that has changed its shape are NaN.
  void Store(const AnyValues& values, std::span<double> row) const;

 private:
  std::vector<RecordedValue> values_;
  std::vector<std::size_t> widths_;  // of the values, in numbers
  std::size_t size_ = 0;
};

}  // namespace pliant::internal
