/// The shortest straight way from a point inside a superquadric to its surface, in plain floating point. Proposes,
/// proves nothing.
#pragma once

#include "verify/proposals/boundary.hpp"
#include "verify/proposals/triangle.hpp"

namespace verisq::verify {

struct InnerWalk {
  Coordinates<double> direction;  ///< of length 1
  double length;
};

struct InnerWalkLimits {
  double steady_direction;  ///< the error of the length is of second order in that of the direction
  int most_walks;
};

/// By walks along the normal of the surface where the last one ended, which never lengthens the way and stops at a
/// locally shortest one. `q` lies where Boundary knows the solid; of a tapered one walks go down, too.
[[nodiscard]] InnerWalk shortest_walk(const Boundary<double>& boundary, bool is_tapered, const Coordinates<double>& q,
                                      const InnerWalkLimits& limits);

}  // namespace verisq::verify
