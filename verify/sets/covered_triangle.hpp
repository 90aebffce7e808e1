/// Distances of triangles to any model with what proves them: witnesses and covers (docs/mathematics.md §28).
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "verify/proof/exact_checker.hpp"
#include "verify/sets/solid_distance.hpp"
#include "verisq/triangle_distance.hpp"

namespace verisq::verify {

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
