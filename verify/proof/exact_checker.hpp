/// What certificates prove of the distances to an ordinary model.
#pragma once

#include <variant>
#include <vector>

#include "verify/proof/posed_bent.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verisq/certificate.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

using PosedPrimitive = std::variant<PosedSuperquadric, PosedBent>;

/// Immutable after construction: safe to call from many threads.
class ExactChecker {
 public:
  /// Throws Error(input) unless the model is_union.
  explicit ExactChecker(const Model& model);

  /// What the certificate proves, whatever it holds: an enclosure of the exact signed distance; an inner end is proven
  /// no farther than claimed. Preconditions as for Checker.
  [[nodiscard]] Enclosure operator()(const Point& point, const Enclosure& claimed,
                                     const Certificate& certificate) const;

  /// The same of the distance of a triangle. Throws Error(input) where a primitive is bent.
  [[nodiscard]] Enclosure operator()(const Triangle& triangle, const Enclosure& claimed,
                                     const Certificate& certificate) const;

 private:
  std::vector<PosedPrimitive> primitives_;
};

}  // namespace verisq::verify
