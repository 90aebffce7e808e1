/// Unions of convex primitives on their way: planes that stay between two of them prove whole stretches of time
/// (docs/mathematics.md §26).
#pragma once

#include "verify/pairs/moving_pairs.hpp"
#include "verify/sweep/path_moments.hpp"
#include "verify/sweep/posed_path.hpp"

namespace verisq::verify {

class ConvexMoments : public PathMoments {
 public:
  /// B moves. Precondition: unions of convex primitives. The path must outlive this.
  ConvexMoments(const PosedPath& path, const Model& a, const Model& b) : path_(&path), a_(a), b_(b) {}

  /// Pairs whose distance is proven to be more than `enough` by their spheres are not looked at closer.
  [[nodiscard]] Moment examine(const Stretch& stretch, double enough) const override;

 private:
  const PosedPath* path_;
  PosedPrimitives a_;
  PosedPrimitives b_;
};

}  // namespace verisq::verify
