/// What certificates prove of the distances to an ordinary model.
#pragma once

#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verisq/certificate.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Immutable after construction: safe to call from many threads.
class ExactChecker {
 public:
  /// Throws Error(input) unless the model is_union_of_convex.
  explicit ExactChecker(const Model& model);

  /// What the certificate proves, whatever it holds: an enclosure of the exact signed distance; an inner end is proven
  /// no farther than claimed. Preconditions as for Checker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed,
                                     const Certificate& certificate) const;

  /// The same of the distance of a triangle.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed,
                                     const Certificate& certificate) const;

 private:
  std::vector<PosedSuperquadric> primitives_;
};

}  // namespace verisq::verify
