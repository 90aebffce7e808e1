/// A mesh that is closed over its rims, and on which side of it a point lies (docs/mathematics.md §22).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/containment/closed_surface.hpp"
#include "verify/containment/rims.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Throws Error(input) for a mesh without triangles, and unless every edge is one of at most two triangles, which run
/// through it in opposite ways. Precondition: triangles of vertices that are there.
void require_sides(const Mesh& mesh);

/// Immutable: safe to ask from many threads.
class OrientedSurface {
 public:
  /// Preconditions: triangles of vertices that are there, finite coordinates. Throws as `require_sides`.
  explicit OrientedSurface(const Mesh& mesh);

  /// Its triangles, and after them those that close it over its rims.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return closed_.triangles(); }
  [[nodiscard]] std::size_t triangles_of_mesh() const { return triangles().size() - closing_.mesh.triangles.size(); }
  [[nodiscard]] std::size_t rims() const { return closing_.rims; }
  /// Whether its normals point outward; nothing where that is not proven.
  [[nodiscard]] std::optional<bool> faces_outward() const {
    return orientation_ ? std::optional(*orientation_ > 0) : std::nullopt;
  }
  /// Sets of its triangles that are connected through edges.
  [[nodiscard]] std::size_t components() const { return components_; }

  enum class Side : std::uint8_t { inside, outside, neither };

  /// Inside is where it winds about the point as it does about its volume, outside where it does not wind; neither
  /// where it winds the other way about, because it crosses itself. Nothing where that is not proven, as on the
  /// surface. Precondition: finite.
  [[nodiscard]] std::optional<Side> side_of(const Point& point) const;

 private:
  Closing closing_;
  std::size_t components_;
  ClosedSurface closed_;
  std::optional<int> orientation_;  ///< the proven sign of the volume that it encloses
};

}  // namespace verisq::verify
