/// A tree of triangles, and the distances of points and polygons to them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The distance of a point from a triangle, enclosed by one pass in floating point (docs/mathematics.md §20).

/// Encloses the Euclidean distance from `point` to the closed triangle of exactly these corners, which may lie on a
/// line or coincide. Coordinates so large that squares overflow, and distances below 2^-500, get wide enclosures.
/// Precondition: finite.
[[nodiscard]] Enclosure distance_from_triangle(const Point& point, const Triangle& triangle);

/// The upper end of the distance alone.
[[nodiscard]] double distance_from_triangle_up(const Point& point, const Triangle& triangle);

// A tree of boxes over triangles: encloses the distance of a point from all of them.

/// Points are triangles whose corners coincide. Immutable: many threads may call it.
class TriangleTree {
 public:
  /// Precondition: at least one triangle, finite corners.
  explicit TriangleTree(std::vector<Triangle> triangles);

  struct Nearest {
    Enclosure distance;      ///< distance to the nearest of all triangles
    std::uint32_t triangle;  ///< one that is no farther than distance.hi, by `triangle(...)`
  };

  /// Precondition: finite.
  [[nodiscard]] Nearest nearest(const Point& point) const;

  /// Returns whether every triangle but n is proven to be farther than `reach` from the point.
  [[nodiscard]] bool alone(const Point& point, double reach, std::uint32_t n) const;

  /// All triangles that are not proven to be farther than `reach` from the point.
  [[nodiscard]] std::vector<std::uint32_t> within(const Point& point, double reach) const;

  /// All triangles whose own box has a point with the box from `lower` to `upper` in common. Precondition: no NaN; ends
  /// may be infinite.
  [[nodiscard]] std::vector<std::uint32_t> overlapping(const Point& lower, const Point& upper) const;

  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] const Triangle& triangle(std::uint32_t n) const { return triangles_[n]; }

  /// The least box about all triangles.
  [[nodiscard]] const Point& lower() const { return nodes_[0].lower; }
  [[nodiscard]] const Point& upper() const { return nodes_[0].upper; }

 private:
  /// Boxes are exact: least and greatest coordinates.
  struct Node {
    Point lower;
    Point upper;
    std::uint32_t first;  ///< triangle of a leaf, else the second child; the first follows its parent
    std::uint32_t count;  ///< number of triangles; 0 for an inner node
  };

  std::uint32_t build(std::span<Triangle> triangles, std::uint32_t first);
  /// Calls look(n) for each triangle of each leaf, unless passes(node) of it or of a node above is true, until a call
  /// returns false. Returns whether none did.
  template <class Passes, class Look>
  bool all_of(const Passes& passes, const Look& look) const;

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

/// Each triangle of the mesh, or each vertex of a cloud as a triangle. Precondition: indices in range.
[[nodiscard]] std::vector<Triangle> triangles_of(const Mesh& mesh);

// Upper bounds of the distances of a small polygon's points from many triangles. The polygon is cut along the sides of
// the triangles over which it lies (docs/mathematics.md §20).

/// An upper bound of the distance from the triangles over the convex hull of three points. Stops as soon as the bound
/// is below `enough`. `first` is the triangle to begin with.
[[nodiscard]] double farthest_of_polygon(std::span<const Point, 3> corners, const TriangleTree& triangles,
                                         std::uint32_t first, double enough);

}  // namespace verisq::verify
