/// By the ball about the patch's sample, else by the two flat triangles near which the patch lies.
#include "verify/deviation/patch_distance.hpp"

#include <algorithm>

#include "verify/deviation/polygon_distance.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::verify {

PatchDistance distance_from(const Patch& patch, const TriangleTree& triangles, double enough) {
  const TriangleTree::Nearest nearest = triangles.nearest(patch.sample);
  // The distance is 1-Lipschitz. Rounded up: sums of nonnegative terms.
  const double by_ball = add(nearest.distance.hi, patch.radius, Direction::up);
  if (by_ball <= enough) return {by_ball, nearest.distance};
  const double inner = subtract(enough, patch.thickness, Direction::down);
  double farthest = 0.0;
  for (const Triangle& half : patch.halves()) {
    farthest = std::max(farthest, farthest_of_polygon(half, triangles, nearest.triangle, inner));
  }
  return {std::min(by_ball, add(farthest, patch.thickness, Direction::up)), nearest.distance};
}

}  // namespace verisq::verify
