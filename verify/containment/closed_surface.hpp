/// Which points a closed surface encloses, by the triangles that a segment from a point to the outside crosses:
/// certain, or nothing (docs/mathematics.md §21).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "verisq/mesh.hpp"

namespace verisq::verify {

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

}  // namespace verisq::verify
