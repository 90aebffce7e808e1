/// A triangle mesh as the readers deliver it: vertices merged, indices checked.
#pragma once

#include <array>
#include <cstdint>
#include <vector>
#include <verisq/model.hpp>

namespace verisq {

/// The three corners of a triangle.
using Triangle = std::array<Point, 3>;

/// Every index is below `vertices.size()`; every coordinate is finite. A point cloud has no triangles.
struct Mesh {
  std::vector<Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

}  // namespace verisq
