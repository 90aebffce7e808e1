/// Which vertices of a mesh tell enough of others to say what is in contact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq {

/// Of each vertex the one by which it is told: whatever its distance is, |d(v) - d(w)| <= |v - w|. Itself where that
/// would not be enough to say of all of its triangles that they are farther than `distance`, or that they are not.
/// `rows`: signed distances of the vertices, which may be unbounded; those that prove it later may be off by
/// `tolerance`. Nothing is proven by this. Precondition: finite coordinates, triangles of vertices that are there.
[[nodiscard]] std::vector<std::uint32_t> tellers(const Mesh& mesh, std::span<const Enclosure> rows, double distance,
                                                 double tolerance);

}  // namespace verisq
