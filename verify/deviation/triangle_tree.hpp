/// A tree of boxes over triangles: the distance of a point from all of them, enclosed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Points are triangles whose corners coincide. Immutable: safe to ask from many threads.
class TriangleTree {
 public:
  /// Precondition: at least one triangle, finite corners.
  explicit TriangleTree(std::vector<Triangle> triangles);

  struct Nearest {
    Enclosure distance;      ///< to the nearest of all triangles
    std::uint32_t triangle;  ///< one that is no farther than distance.hi, by `triangle(...)`
  };

  /// Precondition: finite.
  [[nodiscard]] Nearest nearest(const Point& point) const;

  /// Whether every triangle but n is proven to be farther than `reach` from the point.
  [[nodiscard]] bool alone(const Point& point, double reach, std::uint32_t n) const;

  [[nodiscard]] const Triangle& triangle(std::uint32_t n) const { return triangles_[n]; }

 private:
  /// Boxes are exact: least and greatest coordinates.
  struct Node {
    Point lower;
    Point upper;
    std::uint32_t first;  ///< triangle of a leaf, else the second child; the first follows its parent
    std::uint32_t count;  ///< of triangles; 0 for an inner node
  };

  std::uint32_t build(std::span<Triangle> triangles, std::uint32_t first);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;
};

/// Each triangle of the mesh, or each vertex of a cloud as a triangle. Precondition: indices in range.
[[nodiscard]] std::vector<Triangle> triangles_of(const Mesh& mesh);

}  // namespace verisq::verify
