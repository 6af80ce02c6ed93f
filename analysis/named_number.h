#pragma once

#include <string>

#include "pliant/analysis/signal_number.h"

namespace pliant {

/// A number that each run of a sweep is measured by.
struct NamedNumber {
  std::string name;   ///< of its column: letters, digits, '_' and '-'
  std::string title;  ///< in figures
  SignalNumber number = {};

  template <class F>
  void Parameters(F&& f) {
    f("name", name);
    f("title", title);
    number.Parameters(f);
  }
};

}  // namespace pliant
