/// Newton steps onto the sets with growing margins; descent by tangent planes within shrinking cubes.
#include "verify/sets/solid_pair_points.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "verify/sets/solid_pair_bound.hpp"

namespace verisq::verify {

namespace {

constexpr int kMostMargins = 14;
constexpr int kMostDescents = 40;

double largest(const Point& x) {
  return std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])});
}

/// The tangent planes at x, lowered by `margin`, in a cube of this half-width about x.
CutCube lowered(const SearchSolid& solid, const SetNode& set, const Point& x, double half_width, double margin) {
  const CutCube tangent = relaxation(solid, set, {x, 0.0});
  std::vector<HalfSpace> half_spaces(tangent.half_spaces().begin(), tangent.half_spaces().end());
  for (HalfSpace& half_space : half_spaces) {
    const Point& n = half_space.normal;
    half_space.offset -= margin * std::hypot(n[0], n[1], n[2]);
  }
  return {{x, half_width}, half_spaces};
}

/// Where no plane tells the shape, at a tip or an edge: on the ways into the primitives that it may be a tip of. Bent
/// or not, a primitive contains its centre.
std::optional<Point> settle_towards_centres(const SearchSolid& solid, const Cell& cell, const Point& x) {
  std::optional<Point> settled;
  for_each_containing(*cell.set, [&](std::uint32_t primitive) {
    const Point centre = solid.separable[primitive].about.point({});
    for (double part = 0x1p-46; !settled && part < 0x1p-4; part *= 16.0) {
      Point inside = x;
      for (std::size_t i = 0; i < 3; ++i) inside[i] += part * (centre[i] - x[i]);
      if (strictly_inside(solid, *cell.part, {inside, 0.0})) settled = inside;
    }
  });
  return settled;
}

/// A point proven to lie in the cell's part, near x. The tangent plane of a convex gauge lies outside, hence the
/// margins: they begin with the rounding error and grow until the curvature is paid for.
std::optional<Point> settle(const SearchSolid& solid, const Cell& cell, Point x, double scale) {
  double margin = 0x1p-51 * (largest(x) + scale);
  for (int i = 0; i < kMostMargins; ++i) {
    x = lowered(solid, *cell.set, x, scale, margin).nearest(x);
    if (strictly_inside(solid, *cell.part, {x, 0.0})) return x;
    if (i > 0) margin *= 8.0;
  }
  return std::nullopt;
}

}  // namespace

std::optional<NearPoints> PointSearch::both(const std::optional<Point>& on_a, const std::optional<Point>& on_b) const {
  if (!on_a || !on_b) return std::nullopt;
  return NearPoints{*on_a, *on_b, motion_->distance_up(*on_a, *on_b)};
}

std::optional<NearPoints> PointSearch::settled(const Cell& x, const Cell& y, const Point& near_a, const Point& near_b,
                                               double scale) const {
  const std::optional<Point> on_a = settle(*a_, x, near_a, scale);
  return on_a ? both(on_a, settle(*b_, y, near_b, scale)) : std::nullopt;
}

std::optional<NearPoints> PointSearch::settled_towards_centres(const Cell& x, const Cell& y, const Point& near_a,
                                                               const Point& near_b) const {
  const std::optional<Point> on_a = settle_towards_centres(*a_, x, near_a);
  return on_a ? both(on_a, settle_towards_centres(*b_, y, near_b)) : std::nullopt;
}

NearPoints PointSearch::improved(const Cell& x, const Cell& y, NearPoints points, double scale, double gain) const {
  for (int i = 0; i < kMostDescents; ++i) {
    const CutCube around_a = lowered(*a_, *x.set, points.on_a, scale, 0.0);
    const CutCube around_b = lowered(*b_, *y.set, points.on_b, scale, 0.0);
    const Approach step = approach(around_a, around_b, *motion_, {}, points.distance);
    const double promised = points.distance - step.between;
    if (!(promised > gain)) break;  // a smaller cube promises less still
    const std::optional<NearPoints> next = settled(x, y, step.on_a, step.on_b, scale);
    const double gained = next ? points.distance - next->distance : 0.0;
    if (gained > 0.0) points = *next;
    if (gained < 0.5 * promised) scale *= 0.25;
  }
  return points;
}

bool PointSearch::common(const Cell& x, const Cell& y, const Point& at) const {
  return strictly_inside(*a_, *x.part, {at, 0.0}) && strictly_inside(*b_, *y.part, motion_->enclosed_in_b(at));
}

}  // namespace verisq::verify
