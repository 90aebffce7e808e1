/// GJK outside, walks along normals inside.
#include "verify/proposals/nearest_normal.hpp"

#include <cmath>

#include "verify/proposals/gjk.hpp"
#include "verify/proposals/inner_walk.hpp"

namespace verisq::verify {

namespace {

using Vector = Coordinates<double>;

constexpr InnerWalkLimits enough_walks{.steady_direction = 1e-4, .most_walks = 20};
constexpr GjkTolerance<double> near_enough{.relative = 1e-6, .absolute = 0.0, .most_steps = 60};

}  // namespace

NearestNormal::NearestNormal(const Superquadric& solid) : set_(solid), boundary_(solid), tapered_(is_tapered(solid)) {}

NearestNormal::Found NearestNormal::operator()(const Vector& q) const {
  // Boundary knows the octant of nonnegative coordinates, of a tapered solid the one below it, too.
  const Vector folded{std::fabs(q[0]), std::fabs(q[1]), tapered_ ? q[2] : std::fabs(q[2])};
  if (boundary_.gauge(folded) >= 1.0) return from_outside(q);
  auto [normal, length] = shortest_walk(boundary_, tapered_, folded, enough_walks);
  for (std::size_t i = 0; i < 3; ++i) {
    if (i < 2 || !tapered_) normal[i] = std::copysign(normal[i], q[i]);
  }
  return {normal, -length};
}

NearestNormal::Found NearestNormal::from_outside(const Vector& q) const {
  const GjkResult<double> found = gjk<double>(set_, PointSet<double>{q}, q, near_enough);
  const double length = std::sqrt(dot(found.separation, found.separation));
  if (!(length > 0.0) || !(found.lower > 0.0)) return {{}, 0.0};
  return {{found.separation[0] / length, found.separation[1] / length, found.separation[2] / length}, found.lower};
}

}  // namespace verisq::verify
