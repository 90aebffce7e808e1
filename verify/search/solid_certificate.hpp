/// Searches for the covers that certify a distance to a set operation.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/empty_neighbourhood.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/search/union_of_convex.hpp"
#include "verisq/distance.hpp"

namespace verisq::verify {

// Looks for covers (docs/mathematics.md §28): of a neighbourhood as large as one is found for.

/// A neighbourhood of some radius that is proven to hold nothing.
struct EmptyRadius {
  double radius;
  std::vector<Normal> normals;  ///< of the primitives that have the whole neighbourhood on one side
  std::vector<bool> cover;
};

/// Nothing where it takes more cells than `most`, or `interrupted` says so.
[[nodiscard]] std::optional<std::vector<bool>> cover_of(const EmptyNeighbourhood& neighbourhood, std::size_t most,
                                                        const std::function<bool()>& interrupted);

/// Of one point, triangle or body.
struct CoverQuestion {
  std::function<std::vector<Normal>(double radius)> telling;  ///< normals as above
  std::function<EmptyNeighbourhood(double radius, const std::vector<Normal>&)> neighbourhood;
  std::size_t most_cells = 3000;
};

/// A radius a little smaller than `distance`, that of a witness: by rounding, by up to `tolerance`, or by more where
/// the cover would have too many cells. Nothing where there is none, or `interrupted` says so.
[[nodiscard]] std::optional<EmptyRadius> empty_radius(const CoverQuestion& question, double distance, double tolerance,
                                                      const std::function<bool()>& interrupted);

// Witnesses (docs/mathematics.md §28): points proven to lie in a solid, or beyond it, hardly farther than any are.

/// By at most `tolerance` farther from x; nothing where none was found.
[[nodiscard]] std::optional<Point> nearest_witness(const SolidDistance& search, const Point& x, Side side,
                                                   double tolerance, const std::function<bool()>& interrupted);

// Signed distances to any model with what proves them: witnesses and covers (docs/mathematics.md §28).

/// One model, ready to be searched and proven. Keeps references.
struct CoveredSolid {
  std::span<const UnionPart> parts;  ///< its primitives
  const SolidDistance& search;
  const ExactChecker& checker;
};

/// What `found` proves, narrowed by witnesses and a cover until it is at most `tolerance` wide, a cover would have too
/// many cells or `interrupted` says so. `found` may be nothing at all: an infinite enclosure without a certificate. The
/// enclosure is what the checker proves.
[[nodiscard]] CertifiedEnclosure covered(const CoveredSolid& solid, const Point& x, const CertifiedEnclosure& found,
                                         double tolerance, const std::function<bool()>& interrupted);

// Distances of triangles to any model with what proves them: witnesses and covers (docs/mathematics.md §28).

/// One model, ready to be searched and proven. Keeps references.
struct CoveredModel {
  std::span<const std::optional<TriangleDistance>> convex;  ///< of each primitive alone that is not bent
  const SolidDistance& search;
  const ExactChecker& checker;
};

/// About a point of the triangle that is hardly farther from the solid than any: until it is at most `tolerance` wide,
/// a cover would have too many cells or `interrupted` says so. The enclosure is what the checker proves.
[[nodiscard]] CertifiedEnclosure covered(const CoveredModel& model, const Triangle& triangle, const Point& nearest,
                                         double tolerance, const std::function<bool()>& interrupted);

}  // namespace verisq::verify
