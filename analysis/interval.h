#pragma once

namespace pliant {

/// Between two numbers, in which another is believed to lie.
struct Interval {
  double lower, upper;
};

}  // namespace pliant
