/// The primitives of two models, one of which moves, about a moment: what single evaluations prove of a stretch of
/// time.
#pragma once

#include <vector>

#include "verify/proof/posed_pairs.hpp"

namespace verisq::verify {

/// x'(s) = spin x (x - t(s)) + velocity for every point x of the moving model, t being where its origin is.
struct SteadyMotion {
  PreciseVector velocity;
  PreciseVector spin;  ///< constant, as the velocity is
};

/// Model B moves; at the moment it is at `pose`. All lower bounds hold for all times at most `reach` before or after
/// it, as long as the motion lasts (docs/mathematics.md §26). The models must outlive this.
class MovingPairs {
 public:
  MovingPairs(const PosedPrimitives& a, const PosedPrimitives& b, const RigidMotion& pose, const SteadyMotion& motion);

  /// At the moment.
  [[nodiscard]] const PosedPairs& pairs() const { return pairs_; }

  /// Of the distance of two primitives, by the spheres about them. Rounded down; may be negative.
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j, double reach) const;

  /// By any direction in the frame of A's primitive, best from A to B; -infinity for one that is zero or not finite.
  [[nodiscard]] double lower_by_vector(std::size_t i, std::size_t j, const Point& vector, double reach) const;

 private:
  /// Of a primitive of B.
  struct Arc {
    PreciseVector from_origin;     ///< its centre, from the origin of B, in A's frame
    PreciseInterval speed;         ///< of its centre
    PreciseInterval acceleration;  ///< no smaller than that of any of its points, at all times
    PreciseInterval centre_acceleration;
  };

  const PosedPrimitives* a_;
  const PosedPrimitives* b_;
  SteadyMotion motion_;
  PosedPairs pairs_;
  PreciseVector origin_;
  std::vector<Arc> arcs_;
};

}  // namespace verisq::verify
