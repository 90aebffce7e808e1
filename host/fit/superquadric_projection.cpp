/// Newton's method outside, walks along normals inside.
#include "host/fit/superquadric_projection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "verify/search/convex_primitive.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::fit_search {

namespace {

using Eigen::Array3d;
using Eigen::Vector3d;
using Octant = verify::Boundary<double>::Vector;  ///< nonnegative coordinates

/// The error of the distance is of second order in that of the direction.
constexpr double kSteadyDirection = 1e-7;
constexpr int kMostWalks = 60;
/// Of the semi-axes: of the proof that serves where Newton's method does not.
constexpr double kProofTolerance = 1e-9;

/// A way from a point inside to the surface.
struct Walk {
  Octant direction;
  double length;
};

Octant along(const Octant& q, const Walk& walk) {
  return {q[0] + walk.length * walk.direction[0], q[1] + walk.length * walk.direction[1],
          q[2] + walk.length * walk.direction[2]};
}

double difference(const Octant& a, const Octant& b) {
  return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

/// The shortest along an axis, or along the normal that the surface has behind the point.
Walk first_walk(const verify::Boundary<double>& boundary, const Octant& q) {
  Walk shortest{{}, infinity};
  const auto consider = [&](const Octant& direction) {
    const double length = boundary.exit(q, direction);
    if (length < shortest.length) shortest = {direction, length};
  };
  consider({1.0, 0.0, 0.0});
  consider({0.0, 1.0, 0.0});
  consider({0.0, 0.0, 1.0});
  if (boundary.gauge(q) > 0.0) consider(boundary.normal(q));
  return shortest;
}

}  // namespace

SuperquadricProjection::SuperquadricProjection(const Superquadric& solid)
    : solid_(solid), outside_(solid), boundary_(solid) {}

double SuperquadricProjection::lower_bound(const Vector3d& q) const {
  const Array3d beyond = q.array().abs() - Array3d(solid_.semi_axes[0], solid_.semi_axes[1], solid_.semi_axes[2]);
  const double largest = beyond.maxCoeff();
  return largest > 0.0 ? beyond.max(0.0).matrix().norm() : largest;
}

Projection SuperquadricProjection::operator()(const Vector3d& q) const {
  const verify::DistanceExpansion found = outside_(q);
  if (found.inside) return from_inside(q);
  const double distance = found.gradient.norm();
  if (!std::isfinite(found.value) || !(distance > 0.0)) return proven(q);
  return {distance, found.gradient / distance, q - found.gradient};
}

// A plane through x with normal n(x) supports the solid: the walk from q along n(x) ends no later than at that plane,
// which is no farther from q than x.
Projection SuperquadricProjection::from_inside(const Vector3d& q) const {
  const Octant magnitudes{std::fabs(q[0]), std::fabs(q[1]), std::fabs(q[2])};
  Walk walk = first_walk(boundary_, magnitudes);
  for (int i = 0; i < kMostWalks; ++i) {
    const Octant normal = boundary_.normal(along(magnitudes, walk));
    const double change = difference(normal, walk.direction);
    const Walk next{normal, boundary_.exit(magnitudes, normal)};
    if (!(next.length <= walk.length)) break;
    walk = next;
    if (change < kSteadyDirection) break;
  }
  Vector3d normal;
  for (int i = 0; i < 3; ++i) normal[i] = std::copysign(walk.direction[static_cast<std::size_t>(i)], q[i]);
  return {-walk.length, normal, q + walk.length * normal};
}

Projection SuperquadricProjection::proven(const Vector3d& q) const {
  const double tolerance = kProofTolerance * std::ranges::max(solid_.semi_axes);
  const verify::CertifiedDistance found =
      verify::ConvexPrimitive({"", solid_, {}, {}}).signed_distance({q[0], q[1], q[2]}, tolerance);
  const Vector3d direction(static_cast<double>(found.direction[0]), static_cast<double>(found.direction[1]),
                           static_cast<double>(found.direction[2]));
  const double distance = std::midpoint(found.distance.lo, found.distance.hi);
  const Vector3d normal = direction.stableNormalized();
  return {distance, normal, q - distance * normal};
}

}  // namespace verisq::fit_search
