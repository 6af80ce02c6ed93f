#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace pliant::internal {

/// Throws unless the sample, such as "the first sample", has at least so many values, all finite
/// and not so large that powers of them overflow.
void RequireSample(const std::vector<double>& values, std::string_view sample, std::size_t least);

}  // namespace pliant::internal
