/// Ways out of the implant for a prism of points, and normals that show it clear, in plain floating point. Proposes,
/// proves nothing.
#pragma once

#include <optional>
#include <vector>

#include "verify/placement/way_prism.hpp"
#include "verify/proposals/nearest_normal.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/model.hpp"

namespace verisq {

/// Immutable: safe to call from many threads.
class PrismEscape {
 public:
  /// Precondition: is_union_of_convex(implant).
  explicit PrismEscape(const Model& implant);

  /// Where points of the prism leave the implant soonest, those of the deepest first; of length 1. None where it seems
  /// to be clear.
  [[nodiscard]] std::vector<Point> ways_out(const verify::WayPrism& prism) const;

  /// What may show that the moved prism is clear of all solids; nothing where it does not seem to be. `closely`: by
  /// about as much as it is.
  [[nodiscard]] std::optional<MovedCell> moved(const verify::WayPrism& prism, const Point& step, bool closely) const;

 private:
  struct Solid {
    verify::ApproximateMotion<double> motion;
    verify::SuperquadricSet<double> set;
    verify::NearestNormal nearest;
    double radius;  ///< about the origin of its own frame
  };

  std::vector<Solid> solids_;
};

}  // namespace verisq
