/// The edges of a mesh by the places of their ends: a mesh is a solid only if all of them are closed.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "verisq/mesh.hpp"

namespace verisq::verify {

/// The corners of a triangle by numbers that are equal for equal places.
using Corners = std::array<std::uint32_t, 3>;

/// For each triangle. Vertices in one place, as number (-0 is 0), have one number: that of one of them. Precondition:
/// indices in range, finite coordinates.
[[nodiscard]] std::vector<Corners> corners_by_place(const Mesh& mesh);

/// A side of a triangle: its ends in order, and whether the triangle runs from the first to the second.
struct SidedEdge {
  std::uint64_t ends;  ///< the lower number in the upper half
  std::uint32_t triangle;
  std::int32_t direction;  ///< 1 or -1
};

/// All sides between different places, sorted by their ends. Throws Error(input), with the number of open edges, unless
/// each edge is run through as often one way as the other (docs/mathematics.md §29).
[[nodiscard]] std::vector<SidedEdge> closed_edges(std::span<const Corners> triangles);

}  // namespace verisq::verify
