/// What half-spaces prove of all points of a triangle: how deep they lie in a union of convex primitives at most, or
/// how far from it at least (docs/mathematics.md §15).
#pragma once

#include <vector>

#include "verify/proof/posed_superquadric.hpp"
#include "verify/proposals/nearest_normal.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// Off by the square of the triangle's size where a ball about one of its points is off by its size. Immutable: safe to
/// call from many threads.
class HalfSpaceBound {
 public:
  /// Precondition: is_union_of_convex(model).
  explicit HalfSpaceBound(const Model& model);

  /// No signed distance of a point of the triangle is less. Minus infinity where two primitives may hold such a point:
  /// it may lie deeper in their union than in each. Precondition: finite.
  [[nodiscard]] double operator()(const Triangle& triangle) const;

 private:
  struct Solid {
    PosedSuperquadric posed;
    NearestNormal nearest;
    SuperquadricSet<double> set;
  };

  [[nodiscard]] static double lower(const Solid& solid, const Triangle& triangle);

  std::vector<Solid> solids_;
};

}  // namespace verisq::verify
