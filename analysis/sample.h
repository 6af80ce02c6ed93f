#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace pliant::internal {

/// Values up to it have squares and cubes, and products of both, that are finite.
inline constexpr double kLargestOfSample = 1e75;

/// Throws unless the sample, such as "the first sample", has at least so many values, all finite
/// and none larger than kLargestOfSample.
void RequireSample(const std::vector<double>& values, std::string_view sample, std::size_t least);

}  // namespace pliant::internal
