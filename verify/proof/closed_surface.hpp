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

// The connected parts of a mesh's vertices.

/// For each vertex: the vertex that represents its part. Two vertices have the same one if and only if triangles lead
/// from one to the other.
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

/// A vertex of each connected part of the triangles. Parts that only meet in a place have one each.
[[nodiscard]] inline std::vector<Point> one_on_each_part(const Mesh& mesh) {
  const std::vector<std::uint32_t> part = connected_parts(mesh);
  std::vector<bool> seen(part.size(), false);
  std::vector<Point> points;
  for (const auto& triangle : mesh.triangles) {
    const std::uint32_t corner = triangle[0];
    if (!seen[part[corner]]) points.push_back(mesh.vertices[corner]);
    seen[part[corner]] = true;
  }
  return points;
}

// Proves that triangles are a closed surface, and how it is oriented: winding numbers rest on both (docs/mathematics.md
// §22).

/// Returns whether every edge, by the places of its ends, is run through as often one way as the other.
[[nodiscard]] bool is_closed(std::span<const Triangle> triangles);

/// The sign of the volume that a closed surface encloses: 1 if its normals point outward on the whole, -1 if they point
/// inward, at every scale. Nothing if the sign is not proven. Nothing if the volume is below 1e-12 of the volume of the
/// cube about the surface: roundings enclose as little. Precondition: at least one triangle, finite.
[[nodiscard]] std::optional<int> orientation_of(std::span<const Triangle> triangles);

// The points that a closed surface encloses, by the triangles that a segment from a point to the outside crosses.
// Answers are proven, or nothing (docs/mathematics.md §21).

/// Immutable: safe to ask from many threads.
class ClosedSurface {
 public:
  /// Precondition: at least one triangle, finite corners; each side of a triangle is one of an even number of them.
  explicit ClosedSurface(std::vector<Triangle> triangles);

  /// Returns whether the triangles separate the point from infinity an odd number of times. Nothing if the point lies
  /// on them, or so near that binary64 intervals cannot decide. Precondition: finite.
  [[nodiscard]] std::optional<bool> odd(const Point& point) const;

  /// How often the surface winds around the point: outward triangles about it count 1, inward ones -1. Nothing in the
  /// same cases as for `odd`. Preconditions: finite; every edge is run through as often one way as the other.
  [[nodiscard]] std::optional<int> winding_number(const Point& point) const;

  /// By how much the winding number is larger at the end of a segment than at its beginning. Preconditions: as above;
  /// the segment meets none but these triangles.
  [[nodiscard]] std::optional<int> winding_change(const Point& begin, const Point& end,
                                                  std::span<const std::uint32_t> triangles) const;

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  /// The crossings of a segment to the outside.
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

/// The triangles that close a mesh: together with the mesh's triangles they run through every edge as often one way as
/// the other. Preconditions: the corners of each triangle differ; no edge has more than two triangles, or two that run
/// through it the same way.
[[nodiscard]] Closing closing_over_rims(const Mesh& mesh);

/// The triangles of the mesh and of its closing: a closed surface.
[[nodiscard]] std::vector<Triangle> closed_triangles(const Mesh& mesh, const Closing& closing);

// Proves that a cavity lies in the bone around it (docs/mathematics.md §23).

/// Throws Error(input) if no part of a cavity's surface is inside of a surface that bounds bone from outside, but for
/// roundings. Then the cavity belongs to another bone, or has other coordinates; it would be true, but no answer, that
/// nothing is removed of the bone around the cavity. `closed` gives each of the bone's surfaces, closed over its rims.
/// Precondition: triangles of existing vertices, finite coordinates.
void require_cavities_in_bone(const BoneRegion& bone, const std::function<const ClosedSurface&(std::size_t)>& closed);

}  // namespace verisq::verify
