/// The depth of a point inside one convex superquadric, in its own frame, at 200 bits.
#pragma once

#include "tests/oracle/mixed_norm.hpp"

namespace verisq::oracle {

/// How hard to look for the best direction.
enum class Search {
  usual,     ///< thirty starts: finds the best direction but for about one point in 10,000
  thorough,  ///< 2,000 starts, long descents and many more starts for Newton's method: a second or so
};

/// A point of the surface, a normal v there and what it proves: (v·q - h(v))/|v|.
struct DeepestDirection {
  Vector boundary_point;
  Vector normal;
  Real bound;
};

/// Largest (v·q - h(v))/|v| found over directions v: every such value is proven to be at most the signed distance, and
/// the largest of all directions is the signed distance. The search is a descent from a grid of directions, polished
/// by Newton's method at 200 bits: it may miss the best direction, not overshoot it.
/// Precondition: q >= 0 and g(q) < 1.
[[nodiscard]] DeepestDirection deepest_direction(const Superquadric& superquadric, const MixedNorm<Real>& norm,
                                                 const Vector& q, Search search);

}  // namespace verisq::oracle
