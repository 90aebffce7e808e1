/// The hull of points of a convex difference A - B, grown until it shows how far the origin is from its boundary.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"

namespace verisq::verify {

// The expanding polytope algorithm (van den Bergen, 2001), in plain floating point: proposes, proves nothing. It asks a
// convex set for its farthest point along the normal of the facet that is nearest to the origin, until the two are
// about as far. A facet may have the origin on its outer side: then it is expanded first, so that the origin need not
// lie in the first tetrahedron.

/// A set's farthest point along a direction, and a point beside it to be a vertex.
struct FarthestPoint {
  Coordinates<long double> farthest;
  Point vertex;
  Point on_a;  ///< a point of A that the vertex comes from
};

class DifferenceHull {
 public:
  using Vector = Coordinates<long double>;
  /// Nothing where no vertex is found.
  using Support = std::function<std::optional<FarthestPoint>(const Vector&)>;

  explicit DifferenceHull(Support support) : support_(std::move(support)) {}

  struct Limits {
    double tolerance;    ///< ends where `reach` and `depth` differ by no more
    double enough;       ///< ends where `reach` is no more
    std::size_t facets;  ///< ends where there are more
    std::function<bool()> interrupted;
  };

  void grow(const Limits& limits);

  /// The least reach of the set along any direction that was tried, and that direction of length 1. Infinite before one
  /// was.
  [[nodiscard]] double reach() const { return static_cast<double>(reach_); }
  [[nodiscard]] const Vector& direction() const { return direction_; }

  /// About how far the origin is from the nearest facet; negative outside of the hull, 0 before there is a hull.
  [[nodiscard]] double depth() const;

  /// The hull's surface, and for each vertex its point of A.
  struct Surface {
    Mesh mesh;
    std::vector<Point> on_a;
  };
  [[nodiscard]] Surface surface() const;

 private:
  struct Facet {
    std::array<std::uint32_t, 3> corners;
    Vector normal;       ///< outward, of length 1
    long double height;  ///< of its plane above the origin
  };

  [[nodiscard]] std::optional<std::uint32_t> asked(const Vector& direction);
  [[nodiscard]] std::optional<std::uint32_t> farther_of_both_ways(const Vector& direction, const Vector& from);
  [[nodiscard]] bool begin();
  [[nodiscard]] Facet facet(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] const Facet& nearest() const;
  void insert(std::uint32_t vertex);

  Support support_;
  std::vector<FarthestPoint> points_;
  std::vector<Vector> vertices_;
  std::vector<Facet> facets_;
  long double reach_ = infinity;
  Vector direction_{1, 0, 0};
  long double size_ = 0;  ///< the largest coordinate of a vertex
};

}  // namespace verisq::verify
