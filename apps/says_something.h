#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pliant {

/// An empty word is most often a variable of the shell that is not set.
inline CLI::Validator SaysSomething() {
  return {[](const std::string& word) { return word.empty() ? "it is empty" : ""; }, "", ""};
}

}  // namespace pliant
