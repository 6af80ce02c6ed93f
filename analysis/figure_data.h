#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "pliant/analysis/figure.h"

namespace pliant::internal {

inline constexpr std::size_t kMostPoints = 2000;

/// Throws Error if a figure cannot be drawn as it is.
void CheckFigure(const Figure& figure);

/// Whether a number can be drawn: finite, and not what is left of a run that diverged.
bool IsDrawable(double value);

/// Which points to draw of a curve of any length: of each of many stretches the first, those of
/// least and greatest x and y, and one of a gap if there is one. At most kMostPoints.
std::vector<std::size_t> Thinned(std::span<const double> x, std::span<const double> y);

/// Lines "x y" under a comment, a blank line for each gap; empty if there is nothing to draw.
std::string DataOf(const Curve& curve);

}  // namespace pliant::internal
