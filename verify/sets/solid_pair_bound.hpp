/// Lower bounds of the distance of two polytopes, one of which is moved.
#pragma once

#include "verify/sets/bounded_motion.hpp"
#include "verify/sets/solid_pair_polytope.hpp"

namespace verisq::verify {

/// n / |n|, about; zero where n is, or is no vector.
[[nodiscard]] Point unit(const Point& n);

/// At least 0: proven by the slab between the planes normal to n, which is in the frame of A like x, and about as long
/// as 1. Any n is valid.
[[nodiscard]] double lower_by_direction(const CutCube& x, const CutCube& y, const BoundedMotion& motion,
                                        const Point& n);

/// What alternating projections find.
struct Approach {
  double lower;    ///< proven
  double between;  ///< |on_b moved - on_a|, about: what the polytopes leave to be gained
  Point on_a;      ///< in the frame of A; in the polytope, about
  Point on_b;      ///< in the frame of B
};

/// Stops as soon as `lower` is at least `enough`. `guess` is a direction from A to B; it may be poor, or zero.
[[nodiscard]] Approach approach(const CutCube& x, const CutCube& y, const BoundedMotion& motion, const Point& guess,
                                double enough);

}  // namespace verisq::verify
