#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant {

/// The way out of a misspelt name: "; did you mean 'elbow'?" with the name of `known` that is
/// fewest insertions, deletions and replacements away. Empty if nothing is known.
std::string DidYouMean(std::string_view name, const std::vector<std::string>& known);

}  // namespace pliant
