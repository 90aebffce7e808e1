/// At each time the map to the implant's frame is affine, so that every point of the piece is as the corners are
/// (docs/mathematics.md §16).
#include "verify/placement/way_prism.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "verify/analysis/finite_point.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/triangle_certificate.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

Point sum(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

bool are_finite(const Triangle& corners) {
  return std::ranges::all_of(corners, [](const Point& corner) { return is_finite(corner); });
}

/// {v·x <= h(v)} holds the solid, and the hull of both triangles lies beyond it by what the nearer of them does: the
/// same v for both.
double beyond(const PosedSuperquadric& solid, const PosedTriangle& begin, const PosedTriangle& end, const Proposal& v) {
  return std::min(lower_by_normal(solid, begin, v), lower_by_normal(solid, end, v));
}

/// How far the solid is from the hull, at least.
double distance_of(const PosedSuperquadric& solid, const MovedPrism& hull, std::size_t index,
                   std::span<const Normal> normals) {
  const PosedTriangle begin(hull.begin, solid.motion());
  const PosedTriangle end(hull.end, solid.motion());
  double best = -infinity;
  bool has_own = false;
  for (const auto& [primitive, v] : normals) {
    if (primitive != index) continue;
    has_own = true;
    best = std::max(best, beyond(solid, begin, end, {v[0], v[1], v[2]}));
  }
  return has_own ? best : beyond(solid, begin, end, outward_normal(solid, hull));
}

}  // namespace

std::vector<PosedSuperquadric> solids_of(const Model& model) {
  std::vector<PosedSuperquadric> solids;
  for (const Primitive& primitive : model.primitives) solids.emplace_back(primitive);
  return solids;
}

MovedPrism moved(const WayPrism& prism, const Point& step) {
  MovedPrism hull{};
  for (std::size_t i = 0; i < 3; ++i) {
    hull.begin[i] = sum(prism.corners[i].begin.place.centre, step);
    hull.end[i] = sum(prism.corners[i].end.place.centre, step);
  }
  return hull;
}

// A point of the piece is a mean Σ λ_i c_i of its corners, λ_i >= 0, and at any time it is seen at Σ λ_i q_i, where the
// corners are seen at q_i: no farther from Σ λ_i y_i than the farthest of the q_i is from its y_i, whatever these are.
// There are such y_i on the corners' segments, by their chords; and Σ λ_i y_i is in the hull of these. The exact
// corners are seen no farther from q_i than they are from c_i, because motions keep distances.
double offset_of(const WayPrism& prism, const MovedPrism& hull) {
  double offset = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    offset = std::max(offset, offset_of(prism.corners[i], {hull.begin[i], hull.end[i]}));
  return add(offset, prism.off, Direction::up);
}

Proposal outward_normal(const PosedSuperquadric& solid, const MovedPrism& hull) {
  Point middle{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) middle[k] += (hull.begin[i][k] + hull.end[i][k]) / 6.0;
  return is_finite(middle) ? midpoint(solid.motion().local_point(middle)) : Proposal{};
}

// As of a WayPart: all points of the hull are outside, and at least as far as the nearest solid; the signed distance
// changes by no more than a point moves.
double lower_end(std::span<const PosedSuperquadric> solids, const WayPrism& prism, const MovedCell& cell) {
  if (!is_finite(cell.step)) return -infinity;
  const MovedPrism hull = moved(prism, cell.step);
  if (!are_finite(hull.begin) || !are_finite(hull.end)) return -infinity;
  const double offset = offset_of(prism, hull);
  if (!std::isfinite(offset)) return -infinity;
  double nearest = infinity;
  for (std::size_t k = 0; k < solids.size() && nearest > 0.0; ++k)
    nearest = std::min(nearest, distance_of(solids[k], hull, k, cell.normals));
  return nearest > 0.0 && nearest < infinity ? subtract(nearest, offset, Direction::down) : -infinity;
}

}  // namespace verisq::verify
