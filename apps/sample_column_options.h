#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "pliant/analysis/sample_source.h"
#include "pliant/apps/says_something.h"

namespace pliant {

/// --NAME and --NAME-unit. One word is one argument, several are parted by commas: what follows may
/// be a log.
inline void AddColumns(CLI::App& app, SampleColumns& columns, const std::string& name,
                       const std::string& what, const std::string& unit) {
  app.add_option("--" + name, columns.names, what)
      ->check(SaysSomething())
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--" + name + "-unit", columns.unit, "its unit, such as " + unit);
}

}  // namespace pliant
