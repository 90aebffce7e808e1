/// Whether a point lies inside a closed mesh, by the triangles that a segment from it to the outside crosses: certain,
/// or nothing (docs/mathematics.md §21).
#pragma once

#include <optional>
#include <vector>

#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Immutable: safe to ask from many threads.
class MeshParity {
 public:
  /// Precondition: at least one triangle, finite corners; each side of a triangle is one of an even number of them.
  explicit MeshParity(std::vector<Triangle> triangles);

  /// Whether the triangles part the point from infinity an odd number of times; nothing where it lies on them, or so
  /// near that binary64 intervals cannot tell. Precondition: finite.
  [[nodiscard]] std::optional<bool> inside(const Point& point) const;

 private:
  [[nodiscard]] std::optional<bool> odd_crossings(const Point& from, const Point& to) const;

  std::vector<Triangle> triangles_;
  Point lower_;
  Point upper_;
};

}  // namespace verisq::verify
