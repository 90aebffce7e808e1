/// Closed surfaces: their parts, orientation, openings, and the bone around a cavity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>

#include "verisq/clearance.hpp"

namespace verisq::verify {

// Which vertices of a mesh hang together.

/// Of each vertex the one that stands for its part: the same for two just where triangles lead from one to the other.
[[nodiscard]] inline std::vector<std::uint32_t> connected_parts(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    parent[root(b)] = root(a);
    parent[root(c)] = root(a);
  }
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
  return parent;
}

// Whether triangles are a closed surface, and how it is turned: what winding numbers rest on (docs/mathematics.md
// §22).

/// Whether every edge, by the places of its ends, is run through as often one way as the other.
[[nodiscard]] bool is_closed(std::span<const Triangle> triangles);

/// The sign of the volume that a closed surface encloses: 1 where its normals point outward on the whole, -1 where they
/// point inward, at every scale. Nothing where that is not proven, nor where the volume is below 1e-12 of that of the
/// cube about it: so little roundings enclose. Precondition: at least one triangle, finite.
[[nodiscard]] std::optional<int> orientation_of(std::span<const Triangle> triangles);

// Which points a closed surface encloses, by the triangles that a segment from a point to the outside crosses:
// certain, or nothing (docs/mathematics.md §21).

/// Immutable: safe to ask from many threads.
class ClosedSurface {
 public:
  /// Precondition: at least one triangle, finite corners; each side of a triangle is one of an even number of them.
  explicit ClosedSurface(std::vector<Triangle> triangles);

  /// Whether the triangles part the point from infinity an odd number of times; nothing where it lies on them, or so
  /// near that binary64 intervals cannot tell. Precondition: finite.
  [[nodiscard]] std::optional<bool> odd(const Point& point) const;

  /// How often the surface winds around the point: outward triangles about it count 1, inward ones -1. Nothing in the
  /// same cases. Preconditions: finite; every edge is run through as often one way as the other.
  [[nodiscard]] std::optional<int> winding_number(const Point& point) const;

  /// By how much it is larger at the end of a segment than at its begin. Preconditions: as above; the segment meets no
  /// other triangles than those.
  [[nodiscard]] std::optional<int> winding_change(const Point& begin, const Point& end,
                                                  std::span<const std::uint32_t> triangles) const;

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  /// Of a segment to the outside.
  struct Crossings {
    int outward = 0;
    int inward = 0;
  };

  [[nodiscard]] std::optional<Crossings> crossings(const Point& point) const;
  [[nodiscard]] std::optional<Crossings> crossings(const Point& from, const Point& to) const;

  std::vector<Triangle> triangles_;
  Point lower_;
  Point upper_;
};

// The rims of an open mesh, and the triangles that close it over them (docs/mathematics.md §22).

struct Closing {
  Mesh mesh;              ///< a fan over each rim, about the mean of its vertices; no triangle where the mesh is closed
  std::size_t rims = 0;   ///< closed walks along open edges
  std::size_t edges = 0;  ///< open ones
};

/// With the triangles of the mesh, those of the closing run through every edge as often one way as the other.
/// Preconditions: the corners of each triangle differ; no edge has more than two triangles, or two that run through it
/// the same way.
[[nodiscard]] Closing closing_over_rims(const Mesh& mesh);

/// The triangles of both: a closed surface.
[[nodiscard]] std::vector<Triangle> closed_triangles(const Mesh& mesh, const Closing& closing);

// Whether a cavity lies in the bone that is said to be around it (docs/mathematics.md §23).

/// Throws Error(input) where nothing of a cavity's surface is inside of a surface that bounds bone from outside, but
/// for roundings: then it is another bone's, or in other coordinates, and that nothing is removed of the bone around
/// the cavity would be true, and no answer. `closed` gives each of the bone's surfaces, closed over its rims.
/// Precondition: triangles of vertices that are there, finite coordinates.
void require_cavities_in_bone(const BoneRegion& bone, const std::function<const ClosedSurface&(std::size_t)>& closed);

}  // namespace verisq::verify
