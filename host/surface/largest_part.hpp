/// Of a surface in several parts the largest.
#pragma once

#include <cstddef>
#include <verisq/mesh.hpp>

namespace verisq::surface {

struct LargestPart {
  Mesh mesh;  ///< without vertices of no triangle
  std::size_t parts_left_out = 0;
};

/// By area; parts are connected through vertices. No triangles for a mesh that has none.
[[nodiscard]] LargestPart largest_part(const Mesh& mesh);

}  // namespace verisq::surface
