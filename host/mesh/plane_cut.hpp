/// A mesh without what lies beyond a plane.
#pragma once

#include <cstdint>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/plane.hpp>

namespace verisq {

struct CutMesh {
  Mesh mesh;
  std::vector<std::uint32_t> origin;  ///< for each vertex that of the whole mesh which it is, or which lies at the kept
                                      ///< end of its edge: new ones lie where an edge meets the plane, to nearest
};

/// In the order of the whole mesh: vertices that are kept, of triangles or not, then new ones; triangles as they come,
/// those that the plane crosses replaced by one or two.
[[nodiscard]] CutMesh cut_off(const Mesh& mesh, const Plane& plane);

}  // namespace verisq
