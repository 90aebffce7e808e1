/// Outside the nearest primitive decides, inside the one whose closest point no other covers.
#include "verify/sets/union_closest_point.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "verify/search/candidates.hpp"
#include "verify/search/enclosing_box.hpp"

namespace verisq::verify {

namespace {

/// A primitive that may be the nearest.
struct SurfaceCandidate {
  std::uint32_t primitive;
  ClosestSurfacePoint closest;
};

ClosestPoint answer_of(const SurfaceCandidate& candidate) {
  const auto& [distance, point, normal, unique] = candidate.closest;
  return {rounded_outward(distance), rounded_outward(point), rounded_outward(normal), candidate.primitive, unique};
}

/// Those that rough bounds do not prove to be farther than another one.
template <class Part>
std::vector<std::uint32_t> nearly_nearest(std::span<const Part> parts, const Point& x) {
  std::vector<std::pair<double, std::uint32_t>> lower_bounds;
  double upper = infinity;
  const auto sphere_bound = [&](std::size_t i) { return lower_by_sphere(parts[i], x); };
  for (const auto& [bound, i] : nearest_spheres_first(parts.size(), sphere_bound)) {
    if (bound > std::max(upper, 0.0)) break;
    const Enclosure distance = rough_distance(parts[i], x);
    lower_bounds.emplace_back(distance.lo, static_cast<std::uint32_t>(i));
    upper = std::min(upper, distance.hi);
  }
  std::vector<std::uint32_t> nearest;
  for (const auto& [lower, i] : lower_bounds) {
    if (!(lower > std::max(upper, 0.0))) nearest.push_back(i);
  }
  return nearest;
}

/// Those that no other is proven to be nearer than.
template <class Part>
std::vector<SurfaceCandidate> candidates_at(std::span<const Part> parts, const Point& x) {
  const std::vector<std::uint32_t> nearest =
      parts.size() == 1 ? std::vector<std::uint32_t>{0} : nearly_nearest(parts, x);
  std::vector<SurfaceCandidate> candidates;
  Real upper(infinity);
  for (const std::uint32_t i : nearest) {
    candidates.push_back({i, closest_surface_point(parts[i], x)});
    upper = std::min(upper, candidates.back().closest.distance.upper());
  }
  std::erase_if(candidates, [&](const SurfaceCandidate& candidate) {
    return candidate.closest.distance.lower() > std::max(upper, Real(0));
  });
  return candidates;
}

PreciseVector hull_of(const PreciseVector& a, const PreciseVector& b) {
  return {hull(a[0], b[0]), hull(a[1], b[1]), hull(a[2], b[2])};
}

/// Outside all: the boxes of all candidates. Precondition: at least one.
ClosestPoint nearest_of(std::span<const SurfaceCandidate> candidates) {
  if (candidates.size() == 1) return answer_of(candidates.front());
  ClosestSurfacePoint all = candidates.front().closest;
  Real upper = all.distance.upper();
  for (const SurfaceCandidate& candidate : candidates.subspan(1)) {
    all.distance = hull(all.distance, candidate.closest.distance);
    all.point = hull_of(all.point, candidate.closest.point);
    all.normal = hull_of(all.normal, candidate.closest.normal);
    upper = std::min(upper, candidate.closest.distance.upper());
  }
  return {rounded_outward(PreciseInterval(all.distance.lower(), upper)), rounded_outward(all.point),
          rounded_outward(all.normal), std::nullopt, false};
}

/// Whether this primitive's closest point is proven to be that of the union, x lying in it or on its surface.
template <class Part>
bool decides(const SurfaceCandidate& candidate, std::span<const Part> parts) {
  if (!candidate.closest.unique) return false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i != candidate.primitive && !excludes(parts[i], candidate.closest.point)) return false;
  }
  return true;
}

template <class Part>
std::optional<ClosestPoint> closest_point_of(std::span<const Part> parts, const Point& x) {
  const std::vector<SurfaceCandidate> candidates = candidates_at(parts, x);
  const bool outside = std::ranges::all_of(
      candidates, [](const SurfaceCandidate& candidate) { return candidate.closest.distance.lower() > Real(0); });
  if (outside) return nearest_of(candidates);
  for (const SurfaceCandidate& candidate : candidates) {
    const bool inside = candidate.closest.distance.upper() <= Real(0);
    // On the surface but for rounding, x may lie outside: then the others must be farther away.
    const bool alone = candidates.size() == 1;
    if ((inside || alone) && decides(candidate, parts)) return answer_of(candidate);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ClosestPoint> closest_point(std::span<const ConvexPrimitive> primitives, const Point& x) {
  return closest_point_of(primitives, x);
}

std::optional<ClosestPoint> closest_point(std::span<const UnionPart> parts, const Point& x) {
  return closest_point_of(parts, x);
}

}  // namespace verisq::verify
