/// The area of a patch by integrals over its two arcs, one by one: what is lost is of second order in its size. The
/// derivation stands in docs/mathematics.md §20.
#include "verify/deviation/patch_area.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "verify/deviation/surface_patch.hpp"
#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();

/// No less than the integral of |v| over that of v's length along e: all v lie in the cone of these four directions,
/// whose first components are not negative; e is their middle. Infinite where the cone is wide.
double widening_of_cone(const Interval& rise_from, const Interval& run_from, const Interval& rise_to,
                        const Interval& run_to) {
  // Directions between angles: those of the extreme quotients bound all the others.
  const auto angle = [](double rise, double run) { return std::atan2(rise, run); };
  const double least = std::min({angle(rise_from.lower(), run_from.lower()), angle(rise_from.lower(), run_from.upper()),
                                 angle(rise_to.lower(), run_to.lower()), angle(rise_to.lower(), run_to.upper())});
  const double most = std::max({angle(rise_from.upper(), run_from.lower()), angle(rise_from.upper(), run_from.upper()),
                                angle(rise_to.upper(), run_to.lower()), angle(rise_to.upper(), run_to.upper())});
  const double middle = 0.5 * least + 0.5 * most;
  const Interval along(std::cos(middle));  // e, of any length and any direction: nothing is proven by the angles
  const Interval across(std::sin(middle));
  const Interval length = sqrt(square(along) + square(across));
  double least_cosine = 1.0;
  for (const auto& [rise, run] : {std::pair{rise_from, run_from}, std::pair{rise_to, run_to}}) {
    for (const double r : {rise.lower(), rise.upper()}) {
      for (const double s : {run.lower(), run.upper()}) {
        const Interval size = sqrt(square(Interval(r)) + square(Interval(s))) * length;
        if (!(size.lower() > 0.0)) return no_bound;
        const Interval cosine = (Interval(s) * along + Interval(r) * across) / size;
        least_cosine = std::min(least_cosine, cosine.lower());
      }
    }
  }
  constexpr double narrow_enough = 0.1;
  if (!(least_cosine > narrow_enough)) return no_bound;
  return (Interval(1) / Interval(least_cosine)).upper();
}

}  // namespace

/// x is scaled by `scale`, z by the semi-axis. Tangents of the untapered curve are (-N_y, N_x); the taper's derivative
/// takes (dx, dζ) to (s dx + x ds/dζ dζ, dz/dζ dζ).
PlaneArc PatchedSurface::profile(const PatchCell& cell, const Interval& scale) const {
  const Interval sign((cell.octant & 4U) != 0 ? -1.0 : 1.0);
  const Interval height(superquadric_.semi_axes[2]);
  const auto end = [&](const CurvePoint& point, const CurvePoint& normal) {
    const Interval zeta = sign * point.y;
    PlaneVector at{point.x, zeta};
    PlaneVector tangent{-normal.y, sign * normal.x};
    if (tapered_) {
      const Interval fall = Interval(1) - k_ * zeta;
      const Interval s = fall_ / fall;
      at = {s * point.x, (zeta - k_) / fall};
      tangent = {s * tangent[0] + point.x * k_ * s / fall * tangent[1], s / fall * tangent[1]};
    }
    return std::pair{PlaneVector{at[0] * scale, at[1] * height}, PlaneVector{tangent[0] * scale, tangent[1] * height}};
  };
  const auto first = end(along_.from(cell.along), along_.normal_from(cell.along));
  const auto last = end(along_.to(cell.along), along_.normal_to(cell.along));
  return {first.first, last.first, first.second, last.second};
}

/// By which the taper widens the sections at both ends of the profile: between them it is between these.
std::array<Interval, 2> PatchedSurface::taper_scales(const PatchCell& cell) const {
  if (!tapered_) return {Interval(1), Interval(1)};
  const Interval sign((cell.octant & 4U) != 0 ? -1.0 : 1.0);
  const auto scale = [&](const CurvePoint& point) { return fall_ / (Interval(1) - k_ * sign * point.y); };
  return {scale(along_.from(cell.along)), scale(along_.to(cell.along))};
}

PlaneArc PatchedSurface::section(const PatchCell& cell) const {
  const auto& [a, b, c] = superquadric_.semi_axes;
  const Interval width(a);
  const Interval depth(b);
  const auto point = [&](const CurvePoint& p) { return PlaneVector{width * p.x, depth * p.y}; };
  const auto tangent = [&](const CurvePoint& n) { return PlaneVector{-(width * n.y), depth * n.x}; };
  return {point(around_.from(cell.around)), point(around_.to(cell.around)), tangent(around_.normal_from(cell.around)),
          tangent(around_.normal_to(cell.around))};
}

Interval PatchedSurface::bend_stretch(const std::array<Placed, 4>& corners, double beyond) const {
  if (!bend_map_) return 1.0;
  Interval reach = bend_map_->direction().dot(corners[0].straight);
  for (const Placed& corner : corners) reach = hull(reach, bend_map_->direction().dot(corner.straight));
  const Interval stretch = Interval(1) - Interval(bend_->curvature) * (reach + Interval(-beyond, beyond));
  return {std::clamp(stretch.lower(), 0.0, 2.0), std::clamp(stretch.upper(), 0.0, 2.0)};  // |k r| < 1 in the solid
}

PatchArea PatchedSurface::area(const PatchCell& cell) const {
  const std::array<Placed, 4> corners = this->corners(cell);
  const Interval widest(section_radius(cell));  // of β
  const PlaneArc along = profile(cell, widest);
  const PlaneArc around = section(cell);
  const std::optional<ArcBounds> of_profile = bounds_of(along);
  const std::optional<ArcBounds> of_section = bounds_of(around);
  // The section falls: it is no longer than run and rise, and |β| at most √2 times `widest`. The profile's z has one
  // sense; its x is s C `widest`, C falls and s rises or falls. dA <= s C max(m, 1) |(dZ, |β| d(s C))| |dβ|.
  const auto& [s_from, s_to] = taper_scales(cell);
  const Interval& c_from = along_.from(cell.along).x;
  const Interval& c_to = along_.to(cell.along).x;
  const Interval largest_s(std::max(s_from.upper(), s_to.upper()));
  const Interval largest_c(std::max(c_from.upper(), c_to.upper()));
  const Interval way_around = abs(around.to[0] - around.from[0]) + abs(around.to[1] - around.from[1]);
  const Interval way_out = widest * (largest_s * abs(c_from - c_to) + largest_c * abs(s_from - s_to));
  const Interval way_along = abs(along.to[1] - along.from[1]) + way_out;
  const PatchArea coarse{
      {0.0, (Interval(1.5) * largest_s * largest_c * way_around * way_along * Interval(bend_map_ ? 2 : 1)).upper()},
      no_bound,
      no_bound};
  if (!of_profile || !of_section) return coarse;

  // P = widest C, the profile's x; C its scale of the section.
  const Interval least(std::min(along.from[0].lower(), along.to[0].lower()));
  const Interval scale(
      std::max(0.0, least.lower()),
      (Interval(std::max(along.from[0].upper(), along.to[0].upper())) + Interval(of_profile->bulge)).upper());
  const Interval section_bulge = scale / widest * Interval(of_section->bulge);
  const Interval straight = Interval(section_bulge.upper()) + Interval(of_profile->bulge);
  const Interval stretch = bend_stretch(corners, straight.upper());

  // F = ∫ C |dZ| ∫ |dβ|, G = ∫ C dC ∫ β × dβ
  const Interval rise = abs(along.to[1] - along.from[1]);
  const Interval length = of_section->chord * of_section->stretch;
  const Interval under = ((along.from[0] + along.to[0]) / Interval(2) * rise + of_profile->lens) / widest;
  const Interval sector =
      abs(around.from[0] * around.to[1] - around.from[1] * around.to[0]) + Interval(2) * of_section->lens;
  const Interval steep = under * length;
  const Interval flat = (square(along.to[0]) - square(along.from[0])) / Interval(2) / square(widest) * sector;

  // β × dβ = |dβ| / |(N_x / a1, N_y / a2)|
  const CurvePoint& normal_from = around_.normal_from(cell.around);
  const CurvePoint& normal_to = around_.normal_to(cell.around);
  const Interval normal = sqrt(square(hull(normal_from.x, normal_to.x) / Interval(superquadric_.semi_axes[0])) +
                               square(hull(normal_from.y, normal_to.y) / Interval(superquadric_.semi_axes[1])));
  if (!(normal.lower() > 0.0) || !(stretch.lower() > 0.0)) return coarse;
  const Interval support = Interval(1) / normal / widest;

  // (m |dZ|, support dP) has, but for its length, these directions at the ends.
  const auto rise_of = [&](const PlaneVector& tangent) { return support * tangent[0]; };
  const auto run_of = [&](const PlaneVector& tangent) { return stretch * abs(tangent[1]); };
  const double widening = widening_of_cone(rise_of(along.tangent_from), run_of(along.tangent_from),
                                           rise_of(along.tangent_to), run_of(along.tangent_to));
  const Interval size = sqrt(square(stretch * steep) + square(flat));
  const double upper = widening < no_bound ? (size * Interval(widening)).upper() : no_bound;
  // Of arcs that may overlap their neighbours nothing counts from below: it may be counted there.
  const bool is_apart = along_.in_order(cell.along) && around_.in_order(cell.around);
  const Enclosure area{is_apart ? std::max(0.0, size.lower()) : 0.0, std::min(upper, coarse.area.hi)};

  const Interval density =
      scale / widest * length * sqrt(square(stretch * of_profile->speed[1]) + square(support * of_profile->speed[0]));
  const double spread = (density - Interval(std::max(0.0, density.lower()))).upper();
  return {area, area.lo > 0.0 ? (Interval(spread) / Interval(area.lo)).upper() : no_bound,
          flat_thickness(straight, corners)};
}

}  // namespace verisq::verify
