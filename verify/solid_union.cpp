/// Minimum outside, an escape route inside.
#include "verify/solid_union.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace verisq::verify {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The solids that may decide the distance, the nearest bounding sphere first.
std::vector<std::pair<double, const Solid*>> by_sphere_bound(std::span<const Solid> solids, const Point& x) {
  std::vector<std::pair<double, const Solid*>> order;
  order.reserve(solids.size());
  for (const Solid& solid : solids) order.emplace_back(solid.sphere_bound(x), &solid);
  std::ranges::sort(order, {}, [](const auto& entry) { return entry.first; });
  return order;
}

/// Walks from x along u to a point proven strictly outside every solid; the walk's length bounds the depth of x in the
/// union. Beyond its supporting plane of normal u a solid never meets the ray again, so each advance clears one solid
/// for good. Returns minus infinity if the plane of a solid is out of reach.
double escape_bound(std::span<const Solid> solids, const Point& x, const Proposal& u) {
  if (!usable(u)) return -kInfinity;
  double reached = 0.0;
  std::vector<double> clearances;
  for (const Solid& solid : solids) clearances.push_back(solid.ray_clearance(x, u));
  if (!std::ranges::all_of(clearances, [](double s) { return std::isfinite(s); })) return -kInfinity;
  for (bool advanced = true; advanced;) {
    advanced = false;
    for (std::size_t i = 0; i < solids.size(); ++i) {
      if (reached > clearances[i] || solids[i].separated(x, u, reached)) continue;
      // Strictly beyond the plane: solids that touch must not hide the union's interior between them.
      reached = std::nextafter(std::max(reached, clearances[i]), kInfinity);
      advanced = true;
    }
  }
  const PreciseInterval walk = length<Real>(precise(u)) * PreciseInterval(Real(reached));
  return (-walk).lower().to_double(Direction::down);
}

/// For readers of maps: "-0" would look like a sign.
Enclosure without_negative_zero(const Enclosure& e) {
  return {e.lo + 0.0, e.hi + 0.0};
}

}  // namespace

Enclosure signed_distance(std::span<const Solid> solids, const Point& x, double tolerance) {
  Enclosure result{kInfinity, kInfinity};
  std::vector<Proposal> directions;  // of the solids that may touch x
  for (const auto& [bound, solid] : by_sphere_bound(solids, x)) {
    if (bound > result.hi) break;  // neither this solid nor a later one can be the nearest
    const CertifiedDistance nearest = solid->signed_distance(x, tolerance);
    result.lo = std::min(result.lo, nearest.distance.lo);
    result.hi = std::min(result.hi, nearest.distance.hi);  // a ball inside one solid lies inside the union
    // Not only below zero: a point on two surfaces that share a face is inside the union.
    if (nearest.distance.lo <= 0.0) directions.push_back(nearest.direction);
  }
  if (directions.empty() || solids.size() == 1) return without_negative_zero(result);
  result.lo = -kInfinity;
  for (const Proposal& u : directions) result.lo = std::max(result.lo, escape_bound(solids, x, u));
  return without_negative_zero(result);
}

}  // namespace verisq::verify
