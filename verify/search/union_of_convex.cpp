/// Minimum outside, an escape route inside.
#include "verify/search/union_of_convex.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "verify/analysis/distance_up.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proposals/triangle.hpp"
#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// The direction as long as the distance (docs/mathematics.md §3: the closest point is x - v).
Proposal normal_vector(const CertifiedDistance& found) {
  constexpr double shortest = 0x1p-900;  // its components stay normal numbers, unless they do not matter
  const Proposal& u = found.direction;
  const long double length = std::hypot(std::hypot(u[0], u[1]), u[2]);
  const long double scale = std::max(std::fabs(found.distance.hi), shortest) / length;
  return {scale * u[0], scale * u[1], scale * u[2]};
}

/// What proves the ends of one primitive's enclosure: one vector where it does for both, `resolution` being the
/// rounding error of lengths at hand.
std::vector<Normal> normals_of(std::uint32_t primitive, const CertifiedDistance& found, double resolution) {
  const Proposal normal = normal_vector(found);
  const Proposal apart = difference(normal, found.witness);
  const bool same = std::sqrt(dot(apart, apart)) <= resolution;
  if (same || found.distance.hi <= 0.0 || !usable(found.witness)) return {{primitive, rounded(normal)}};
  return {{primitive, rounded(found.witness)}, {primitive, rounded(normal)}};
}

/// How far from x along u a walk leaves every primitive for good. Beyond its supporting plane of normal u a primitive
/// never meets the ray again, so each advance clears one primitive, and with it those whose planes lie before: one look
/// at each, in the order of their planes, is enough. Infinite if the plane of a primitive is out of reach.
double escape_length(std::span<const ConvexPrimitive> primitives, const Point& x, const Proposal& u) {
  std::vector<std::pair<double, const ConvexPrimitive*>> planes;  // how far they are
  for (const ConvexPrimitive& primitive : primitives) planes.emplace_back(primitive.ray_clearance(x, u), &primitive);
  if (!std::ranges::all_of(planes, [](const auto& plane) { return std::isfinite(plane.first); })) return infinity;
  std::ranges::sort(planes);
  double reached = 0.0;
  for (const auto& [clearance, primitive] : planes) {
    // Strictly beyond the plane: primitives that touch must not hide the union's interior between them.
    if (reached <= clearance && !primitive->separated(x, u, reached)) reached = std::nextafter(clearance, infinity);
  }
  return reached;
}

/// A point outside every primitive and how far it lies from x, rounded up.
struct Escape {
  Point point;
  double distance;
};

/// The end of a walk along u, in binary64: the margin that makes up for its rounding grows until the proof succeeds.
std::optional<Escape> escape(std::span<const ConvexPrimitive> primitives, const Point& x, const Proposal& u) {
  if (!usable(u)) return std::nullopt;
  const double walk = escape_length(primitives, x, u);
  const long double length = std::hypot(std::hypot(u[0], u[1]), u[2]);
  const long double size = std::fabs(x[0]) + std::fabs(x[1]) + std::fabs(x[2]) + walk * length;
  if (!std::isfinite(walk)) return std::nullopt;
  for (long double margin = 0.0L; margin < size; margin = std::max(2.0L * margin, 0x1p-54L * size)) {
    const long double s = walk + margin / length;
    const Point w{static_cast<double>(x[0] + s * u[0]), static_cast<double>(x[1] + s * u[1]),
                  static_cast<double>(x[2] + s * u[2])};
    if (!std::ranges::all_of(w, [](double c) { return std::isfinite(c); })) return std::nullopt;
    if (std::ranges::all_of(primitives, [&](const ConvexPrimitive& primitive) { return primitive.excludes(w); })) {
      return Escape{w, distance_up(x, w)};
    }
  }
  return std::nullopt;
}

/// For readers of maps: "-0" would look like a sign.
Enclosure without_negative_zero(const Enclosure& e) {
  return {e.lo + 0.0, e.hi + 0.0};
}

}  // namespace

CertifiedEnclosure signed_distance(std::span<const ConvexPrimitive> primitives, const Point& x, double tolerance) {
  CertifiedEnclosure result{{infinity, infinity}, {}};
  auto& [distance, certificate] = result;
  // A certificate's normals are rounded: where that may hide on which side of a surface x lies, an escape is added.
  const double touching = 0x1p-50 * (std::fabs(x[0]) + std::fabs(x[1]) + std::fabs(x[2]));
  std::vector<Proposal> directions;  // of the primitives that may touch x
  const auto sphere_bound = [&](std::size_t i) { return primitives[i].proof().lower_by_sphere(x); };
  for (const auto& [bound, i] : nearest_spheres_first(primitives.size(), sphere_bound)) {
    const auto index = static_cast<std::uint32_t>(i);
    if (bound > distance.hi) break;  // neither this primitive nor a later one can be the nearest
    const CertifiedDistance nearest = primitives[index].signed_distance(x, tolerance);
    const std::vector<Normal> normals = normals_of(index, nearest, touching);
    const bool decides = nearest.distance.hi < distance.hi;
    certificate.normals.insert(decides ? certificate.normals.begin() : certificate.normals.end(), normals.begin(),
                               normals.end());
    distance.lo = std::min(distance.lo, nearest.distance.lo);
    distance.hi = std::min(distance.hi, nearest.distance.hi);  // a ball inside one primitive lies inside the union
    // Not only below zero: a point on two surfaces that share a face is inside the union.
    if (nearest.distance.lo <= touching) directions.push_back(primitives[index].model_direction(nearest.direction));
  }
  if (!directions.empty() && primitives.size() > 1) {
    double depth = infinity;
    for (const Proposal& u : directions) {
      const std::optional<Escape> found = escape(primitives, x, u);
      if (!found || found->distance >= depth) continue;
      depth = found->distance;
      certificate.escape = found->point;
    }
    if (!(distance.lo > 0.0)) distance.lo = -depth;
  }
  distance = between(distance.lo, distance.hi, [&] { return "the signed distance at " + text_of(x); });
  distance = without_negative_zero(distance);
  return result;
}

}  // namespace verisq::verify
