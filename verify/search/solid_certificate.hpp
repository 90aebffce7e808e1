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

// Searches for covers (docs/mathematics.md §28) of a neighbourhood that is as large as possible.

/// A neighbourhood of some radius that is proven to contain no point of the set.
struct EmptyRadius {
  double radius;
  std::vector<Normal> normals;  ///< for the primitives that have the whole neighbourhood on one side
  std::vector<bool> cover;
};

/// Nothing if the cover takes more cells than `most`, or if `interrupted` returns true.
[[nodiscard]] std::optional<std::vector<bool>> cover_of(const EmptyNeighbourhood& neighbourhood, std::size_t most,
                                                        const std::function<bool()>& interrupted);

/// The neighbourhoods of one point, triangle or body.
struct CoverQuestion {
  std::function<std::vector<Normal>(double radius)> telling;  ///< returns normals as above
  std::function<EmptyNeighbourhood(double radius, const std::vector<Normal>&)> neighbourhood;
  std::size_t most_cells = 3000;
};

/// A radius a little smaller than `distance`, the distance of a witness: by rounding, by up to `tolerance`, or by more
/// if the cover would have too many cells. Nothing if there is none, or if `interrupted` returns true.
[[nodiscard]] std::optional<EmptyRadius> empty_radius(const CoverQuestion& question, double distance, double tolerance,
                                                      const std::function<bool()>& interrupted);

// Signed distances to any model with their proofs: witnesses and covers (docs/mathematics.md §28).

/// One model, ready to be searched and proven. Keeps references.
struct CoveredSolid {
  std::span<const UnionPart> parts;  ///< its primitives
  const SolidDistance& search;
  const ExactChecker& checker;
};

/// The enclosure that `found` proves, narrowed by witnesses and a cover. Stops if it is at most `tolerance` wide, if a
/// cover would have too many cells, or if `interrupted` returns true. `found` may be an infinite enclosure without a
/// certificate. The checker proves the resulting enclosure.
[[nodiscard]] CertifiedEnclosure covered(const CoveredSolid& solid, const Point& x, const CertifiedEnclosure& found,
                                         double tolerance, const std::function<bool()>& interrupted);

// Distances of triangles to any model with their proofs: witnesses and covers (docs/mathematics.md §28).

/// One model, ready to be searched and proven. Keeps references.
struct CoveredModel {
  std::span<const std::optional<TriangleDistance>> convex;  ///< for each primitive that is not bent, alone
  const SolidDistance& search;
  const ExactChecker& checker;
};

/// `nearest` is a point of the triangle that is hardly farther from the solid than the nearest. Stops if the enclosure
/// is at most `tolerance` wide, if a cover would have too many cells, or if `interrupted` returns true. The checker
/// proves the resulting enclosure.
[[nodiscard]] CertifiedEnclosure covered(const CoveredModel& model, const Triangle& triangle, const Point& nearest,
                                         double tolerance, const std::function<bool()>& interrupted);

}  // namespace verisq::verify
