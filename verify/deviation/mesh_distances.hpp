/// How far the triangles of a mesh lie from the boundary of a solid: at most, in the mean, and percentiles
/// (docs/mathematics.md §19).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verify/deviation/deviation_search.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

struct MeshDistances {
  Enclosure largest;  ///< the supremum
  Point where{};      ///< a point of the mesh within rounding of it is `largest.lo` away
  std::optional<Enclosure> mean = {};
  std::vector<Enclosure> percentiles = {};
  std::uint64_t samples = 0;
  bool ended = false;  ///< early: everything is valid, and something wide
};

/// `at_vertices`: signed distances of the mesh's vertices. Without `statistics` there are no mean and percentiles.
/// Precondition: the mesh has triangles; as many enclosures as vertices, each of which may be unbounded.
[[nodiscard]] MeshDistances distances_of_mesh(const Mesh& mesh, std::span<const Enclosure> at_vertices, bool statistics,
                                              std::span<const double> percentiles, const DeviationSearch& search);

}  // namespace verisq::verify
