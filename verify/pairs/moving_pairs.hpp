/// The primitives of two models, one of which moves for a short time: what single evaluations prove of it.
#pragma once

#include "verify/pairs/posed_pairs.hpp"
#include "verify/pairs/short_motion.hpp"

namespace verisq::verify {

/// Model B moves. All lower bounds hold at all times of its short motion. The models must outlive this.
class MovingPairs {
 public:
  MovingPairs(const PosedPrimitives& a, const PosedPrimitives& b, const ShortMotion& motion)
      : a_(&a), b_(&b), motion_(motion), pairs_(a, b, motion.pose()) {}

  /// At the moment.
  [[nodiscard]] const PosedPairs& pairs() const { return pairs_; }

  /// Of the distance of two primitives, by the spheres about them. Rounded down; may be negative.
  [[nodiscard]] double lower_by_spheres(std::size_t i, std::size_t j) const;

  /// By any direction in the frame of A's primitive, best from A to B; -infinity for one that is zero or not finite.
  [[nodiscard]] double lower_by_vector(std::size_t i, std::size_t j, const Point& vector) const;

 private:
  const PosedPrimitives* a_;
  const PosedPrimitives* b_;
  ShortMotion motion_;
  PosedPairs pairs_;
};

}  // namespace verisq::verify
