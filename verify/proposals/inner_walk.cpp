/// Begins along an axis, or along the normal that the surface has behind the point.
#include "verify/proposals/inner_walk.hpp"

#include <algorithm>
#include <cmath>

#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Vector = Coordinates<double>;

double largest_difference(const Vector& a, const Vector& b) {
  return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

InnerWalk first_walk(const Boundary<double>& boundary, bool is_tapered, const Vector& q) {
  InnerWalk shortest{{}, infinity};
  const auto consider = [&](const Vector& direction) {
    const double length = boundary.exit(q, direction);
    if (length < shortest.length) shortest = {direction, length};
  };
  consider({1.0, 0.0, 0.0});
  consider({0.0, 1.0, 0.0});
  consider({0.0, 0.0, 1.0});
  if (is_tapered) consider({0.0, 0.0, -1.0});
  if (boundary.gauge(q) > 0.0) consider(boundary.normal(q));
  return shortest;
}

}  // namespace

// A plane through x with normal n(x) supports the solid: the walk from q along n(x) ends no later than at that plane,
// which is no farther from q than x.
InnerWalk shortest_walk(const Boundary<double>& boundary, bool is_tapered, const Vector& q,
                        const InnerWalkLimits& limits) {
  InnerWalk walk = first_walk(boundary, is_tapered, q);
  for (int i = 0; i < limits.most_walks; ++i) {
    const Vector normal = boundary.normal(along(q, walk.direction, walk.length));
    const double change = largest_difference(normal, walk.direction);
    const double length = boundary.exit(q, normal);
    if (!(length <= walk.length)) break;
    walk = {normal, length};
    if (change < limits.steady_direction) break;
  }
  return walk;
}

}  // namespace verisq::verify
