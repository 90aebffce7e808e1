/// Newton's method outside, walks along normals inside.
#include "host/fit/superquadric_projection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "verify/proposals/inner_walk.hpp"
#include "verify/search/convex_primitive.hpp"

namespace verisq::fit_search {

namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr verify::InnerWalkLimits kWalks{.steady_direction = 1e-7, .most_walks = 60};
/// Of the semi-axes: of the proof that serves where Newton's method does not.
constexpr double kProofTolerance = 1e-9;

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

Projection SuperquadricProjection::from_inside(const Vector3d& q) const {
  const verify::InnerWalk walk =
      verify::shortest_walk(boundary_, false, {std::fabs(q[0]), std::fabs(q[1]), std::fabs(q[2])}, kWalks);
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
