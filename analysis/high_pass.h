#pragma once

#include <Eigen/Core>

#include "pliant/systems/time.h"

namespace pliant {

/// What of a recorded signal lies above a frequency f_c, without a delay: a Butterworth filter of
/// second order, run forward and then backward over rows that are h apart:
///
///   H(z) = (1 − z⁻¹)² / (1 + √2 K + K² + 2 (K² − 1) z⁻¹ + (1 − √2 K + K²) z⁻²),
///   K = tan(π f_c h)
///
///   gain(f) = |H|² = 1 / (1 + (K / tan(π f h))⁴)        ½ at f_c, phase 0
///
/// The bilinear transform of s²/(s² + √2 ω s + ω²) with ω at f_c. Each end is continued by its
/// mirror image through the last point for 3/f_c, after which less than 2·10⁻⁶ is left of what the
/// ends stir up. A column is a row of the log; each row is filtered by itself.
///
/// Source: Gustafsson, IEEE Trans. Signal Processing 44 (1996), 988, for running both ways.
///
/// Throws Error unless 0 < f_c < 1/(2 h).
Eigen::MatrixXd HighPass(const Eigen::MatrixXd& numbers, double cutoff_hz, Duration period);

}  // namespace pliant
