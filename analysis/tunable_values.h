#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pliant/systems/diagram.h"
#include "pliant/systems/record_sink.h"

namespace pliant {

/// A value that may be changed while its diagram runs: an input with a default that nothing is
/// connected to, of numbers, vectors or matrices. What is a struct, such as a pose, is none.
struct TunableValue : RecordedValue {
  enum class Kind { Number, Flag, Word, Numbers, Matrix };
  friend const std::vector<std::string>& Words(Kind) {
    static const std::vector<std::string> words{"number", "flag", "word", "numbers", "matrix"};
    return words;
  }

  const internal::Value* value = nullptr;
  Kind kind = Kind::Number;
  bool whole = false;              ///< whole numbers only
  std::vector<std::string> words;  ///< of a Word
  int rows = 1, cols = 1;          ///< of a Matrix, whose numbers stand column by column
  std::vector<double> start;       ///< the default: of a Word its place among the words

  std::size_t size() const { return start.size(); }
};

/// In order of declaration. The diagram must outlive them.
std::vector<TunableValue> TunableValuesOf(const Diagram& diagram);

}  // namespace pliant
