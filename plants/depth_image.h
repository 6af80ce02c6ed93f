#pragma once

#include <vector>

#include "pliant/systems/signal.h"

namespace pliant {

/// How far away each pixel of a camera sees something: z in the camera's frame [m], row by row from
/// the top left; 0 where there is no reading.
///
/// Its buffer is made for a camera and then only written in place. It can be copied and compared,
/// and is no row of numbers for a log: a recorder refuses it.
struct DepthImage {
  using Space = Nothing;
  static constexpr Quantity quantity{"depth image", "m"};

  DepthImage() = default;
  DepthImage(int columns, int rows)
      : width{columns}, height{rows}, depth(static_cast<std::size_t>(columns * rows)) {}

  double time = -1;  ///< at which it was taken [s]; −1: none was taken yet
  int width = 0, height = 0;
  std::vector<float> depth;

  float at(int column, int row) const {
    return depth[static_cast<std::size_t>(row * width + column)];
  }

  bool operator==(const DepthImage&) const = default;
};

}  // namespace pliant
