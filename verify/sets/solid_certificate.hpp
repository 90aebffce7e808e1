/// Signed distances to any model with what proves them: witnesses and covers (docs/mathematics.md §28).
#pragma once

#include <functional>
#include <span>

#include "verify/proof/exact_checker.hpp"
#include "verify/sets/solid_distance.hpp"
#include "verify/sets/union_closest_point.hpp"

namespace verisq::verify {

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

}  // namespace verisq::verify
