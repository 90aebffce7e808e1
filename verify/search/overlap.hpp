/// Two solids of any kind that overlap: a point deep in both, a short translation that parts them, hulls of convex
/// ones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "verify/proposals/support_mapping.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"
#include "verisq/penetration.hpp"

namespace verisq::verify {

/// Model A, and model B moved by a pose. Searches go on in small steps as long as they find something better: what they
/// find is good, not the best. All points are in the frame of A.
class Overlap {
 public:
  /// `size` is about that of the models. `interrupted` ends every search.
  Overlap(const Model& a, const Model& b, const Pose& pose, double size, std::function<bool()> interrupted);

  /// A point whose depths in both solids have about the largest sum. `common` is a point of both, if one is known.
  [[nodiscard]] Point deepest(const std::optional<Point>& common) const;

  /// Balls about it in both, as large as they are proven to be.
  [[nodiscard]] std::array<InnerBall, 2> balls_about(const Point& x, double tolerance) const;

  /// A translation of B that is shorter than `reach`, the way along `direction` that parts the models' hulls; nothing
  /// where none was found. `deep` is a point of both.
  [[nodiscard]] std::optional<PartingTranslation> parting(const Point& direction, double reach, const Point& deep);

 private:
  struct Deep {
    double depth;  ///< about the sum of both
    Point place;
  };

  [[nodiscard]] Deep deep_at(const Point& x) const;
  [[nodiscard]] Deep climbed(Deep best) const;
  /// About how deep a point lies in each of both.
  [[nodiscard]] std::array<double, 2> depths(const Point& x) const;
  [[nodiscard]] bool still_meet(const Point& translation) const;
  [[nodiscard]] Pose after(const Point& translation) const;
  [[nodiscard]] bool parts(const Point& translation);
  bool shorten(const Point& direction);
  void turn_about_best();

  SignedDistance a_, b_;
  CertifiedDistances certified_;
  std::variant<PairDistance, ModelSearch> distance_;
  Pose pose_;
  ApproximateMotion<double> motion_;
  std::vector<Point> centres_;  ///< of all primitives
  double size_;
  std::function<bool()> interrupted_;
  Point deep_{};  ///< of a parting: a point of both
  std::array<double, 2> depths_of_deep_{};
  Point best_{};           ///< the best direction so far
  double way_ = 0.0;       ///< along it: is known to part
  std::size_t asked_ = 0;  ///< distances
};

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
