/// Encloses the depth of a point by a polyhedron inscribed in the solid and refined where it comes closest.
#pragma once

#include <array>

#include "verisq/model.hpp"

namespace verisq::verify {

struct Depth {
  double lower;                  ///< proven: the ball of this radius about q lies in the solid
  double upper;                  ///< not proven: distance of q to the closest tangent plane found
  std::array<double, 3> normal;  ///< of that plane, in the octant: the direction that certifies the other side
};

/// When to stop.
struct DepthGoal {
  double tolerance;  ///< for upper - lower
  double known;      ///< a lower bound that the caller has proven
  int budget;        ///< points of the surface to prove at most
};

/// Depth of q, the largest t with B(q, t) inside the solid. Preconditions: q >= 0 in the solid's own frame, but for z
/// of a tapered one, g(q) <= 1 proven by the caller, largest semi-axis in [1, 2) and none below 1e-200. With `planar`,
/// q[1] must be 0 and the solid one of revolution about z: the section y = 0 then decides.
[[nodiscard]] Depth enclose_depth(const Superquadric& solid, const std::array<double, 3>& q, bool planar,
                                  const DepthGoal& goal);

}  // namespace verisq::verify
