/// GJK outside, walks along normals inside.
#include "verify/proposals/nearest_normal.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proposals/gjk.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

using Vector = Coordinates<double>;

/// The error of a distance is of second order in that of the direction.
constexpr double steady_direction = 1e-4;
constexpr int most_walks = 20;
constexpr GjkTolerance<double> near_enough{.relative = 1e-6, .absolute = 0.0, .most_steps = 60};

struct Walk {
  Vector direction;
  double length;
};

double largest_difference(const Vector& a, const Vector& b) {
  return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

}  // namespace

NearestNormal::NearestNormal(const Superquadric& solid) : set_(solid), boundary_(solid), tapered_(is_tapered(solid)) {}

NearestNormal::Found NearestNormal::operator()(const Vector& q) const {
  // Boundary knows the octant of nonnegative coordinates, of a tapered solid the one below it, too.
  const Vector folded{std::fabs(q[0]), std::fabs(q[1]), tapered_ ? q[2] : std::fabs(q[2])};
  if (boundary_.gauge(folded) >= 1.0) return from_outside(q);
  Found found = from_inside(folded);
  for (std::size_t i = 0; i < 3; ++i) {
    if (i < 2 || !tapered_) found.normal[i] = std::copysign(found.normal[i], q[i]);
  }
  return found;
}

NearestNormal::Found NearestNormal::from_outside(const Vector& q) const {
  const GjkResult<double> found = gjk<double>(set_, PointSet<double>{q}, q, near_enough);
  const double length = std::sqrt(dot(found.separation, found.separation));
  if (!(length > 0.0) || !(found.lower > 0.0)) return {{}, 0.0};
  return {{found.separation[0] / length, found.separation[1] / length, found.separation[2] / length}, found.lower};
}

// A plane through x with normal n(x) supports the solid: the walk from q along n(x) ends no later than at that plane,
// which is no farther from q than x.
NearestNormal::Found NearestNormal::from_inside(const Vector& folded) const {
  Walk shortest{{}, infinity};
  const auto consider = [&](const Vector& direction) {
    const double length = boundary_.exit(folded, direction);
    if (length < shortest.length) shortest = {direction, length};
  };
  consider({1.0, 0.0, 0.0});
  consider({0.0, 1.0, 0.0});
  consider({0.0, 0.0, 1.0});
  if (tapered_) consider({0.0, 0.0, -1.0});
  if (boundary_.gauge(folded) > 0.0) consider(boundary_.normal(folded));
  for (int i = 0; i < most_walks; ++i) {
    const Vector normal = boundary_.normal(along(folded, shortest.direction, shortest.length));
    const double change = largest_difference(normal, shortest.direction);
    const double length = boundary_.exit(folded, normal);
    if (!(length <= shortest.length)) break;
    shortest = {normal, length};
    if (change < steady_direction) break;
  }
  return {shortest.direction, -shortest.length};
}

}  // namespace verisq::verify
