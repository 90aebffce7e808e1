/// Any two models on their way, bent or built by set operations: planes that stay between sections of primitives, or
/// the distance at a moment and how fast points move, prove a stretch of time (docs/mathematics.md §26).
#pragma once

#include <functional>

#include "verify/pairs/model_pair.hpp"
#include "verify/sets/solid_pair_distance.hpp"
#include "verify/sweep/path_moments.hpp"
#include "verify/sweep/posed_path.hpp"

namespace verisq::verify {

class SearchedMoments : public PathMoments {
 public:
  /// B moves. Distances are enclosed to a quarter of `tolerance` at best. `interrupted`, polled, ends searches. The
  /// path must outlive this.
  SearchedMoments(const PosedPath& path, const Model& a, const Model& b, double tolerance,
                  std::function<bool()> interrupted);

  [[nodiscard]] Moment examine(const Stretch& stretch, double enough) const override;

 private:
  /// How far the distance at any of its times lies from that at the moment, at most.
  [[nodiscard]] PreciseInterval change(const ShortMotion& motion) const;

  /// How far a point of B is from where it is at the exact pose, at most.
  [[nodiscard]] double displacement(const RigidMotion& exact, const RigidMotion& nearby) const;

  /// Whether a point of A's is proven to lie in B, too, at the exact pose.
  [[nodiscard]] bool is_in_b(const Point& x, const RigidMotion& exact) const;

  const PosedPath* path_;
  PairSearch search_;
  ModelPair pair_;
  EnclosingSphere sphere_a_;
  EnclosingSphere sphere_b_;
  double tolerance_;
  std::function<bool()> interrupted_;
};

}  // namespace verisq::verify
