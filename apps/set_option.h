#pragma once

#include <string>
#include <vector>

#include "pliant/plants/parameter_file.h"
#include "pliant/systems/error.h"

namespace pliant {

/// What `--set` says; throws Error for what is no path=value.
inline Overrides OverridesOf(const std::vector<std::string>& set) {
  Overrides overrides;
  for (const std::string& text : set) {
    const std::size_t sign = text.find('=');
    Require(sign != std::string::npos && sign > 0,
            "--set wants path=value, such as station.ideal=true", text);
    overrides.emplace_back(text.substr(0, sign), text.substr(sign + 1));
  }
  return overrides;
}

}  // namespace pliant
