/// This file implements surface_patch.hpp.
#include "verify/proof/surface_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/vector.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {
namespace {

double middle_of(const Interval& a, const Interval& b) {
  return 0.25 * a.lower() + 0.25 * a.upper() + 0.25 * b.lower() + 0.25 * b.upper();
}

/// (x^p + y^p)^(1/p) for nonnegative x and y, rounded to the side.
double norm_of(double x, double y, const NormExponent<Real>& p, Direction direction) {
  return norm_of_two<Real>(Real(x), Real(y), p, direction).to_double(direction);
}

/// From (1, 0) to (0, 1) x falls and y rises; either decides which point comes first.
bool is_before(const CurvePoint& a, const CurvePoint& b) {
  return b.x.upper() < a.x.lower() || a.y.upper() < b.y.lower();
}

}  // namespace

ArcTree::ArcTree(double exponent) : primal_(primal_exponent<Real>(exponent)), dual_(dual_exponent<Real>(exponent)) {
  const CurvePoint first{Interval(1), Interval(0)};
  const CurvePoint last{Interval(0), Interval(1)};
  points_ = {{first, normal_at(first)}, {last, normal_at(last)}};
  arcs_.push_back({0, 1});
}

/// The gradient of x^p + y^p by p. Its product with the point, x^p + y^p, is 1.
CurvePoint ArcTree::normal_at(const CurvePoint& point) const {
  const Interval p = in_binary64(primal_.value);  // 1 at least, but for rounding
  const Interval exponent(std::max(0.0, (p - Interval(1)).lower()), std::max(0.0, (p - Interval(1)).upper()));
  const auto power_of = [&](const Interval& x) {
    return pow(Interval(std::clamp(x.lower(), 0.0, 1.0), std::clamp(x.upper(), 0.0, 1.0)), exponent);
  };
  return {power_of(point.x), power_of(point.y)};
}

/// (x, y) divided by its gauge lies on the curve, whatever x and y are.
CurvePoint ArcTree::point_towards(double x, double y) const {
  const Interval gauge(norm_of(x, y, primal_, Direction::down), norm_of(x, y, primal_, Direction::up));
  return {Interval(x) / gauge, Interval(y) / gauge};
}

void ArcTree::halve(Arc arc) {
  if (arcs_[arc].first_half != 0) return;
  const Entry whole = arcs_[arc];
  const CurvePoint& from = points_[whole.from].point;
  const CurvePoint& to = points_[whole.to].point;
  // Wherever on the curve this point is, the arc from one end to it and the arc from it to the other end cover the
  // whole arc.
  const CurvePoint middle = point_towards(middle_of(from.x, to.x), middle_of(from.y, to.y));
  const bool in_order = whole.in_order && is_before(from, middle) && is_before(middle, to);
  const auto place = static_cast<std::uint32_t>(points_.size());
  points_.push_back({middle, normal_at(middle)});
  arcs_[arc].first_half = static_cast<Arc>(arcs_.size());
  arcs_.push_back({whole.from, place, in_order});
  arcs_.push_back({place, whole.to, in_order});
}

double ArcTree::bulge(Arc arc, double width, double height) const {
  const CurvePoint& from = this->from(arc);
  const CurvePoint& to = this->to(arc);
  const Interval run = abs(from.x - to.x) * Interval(width);
  const Interval rise = abs(from.y - to.y) * Interval(height);
  const Interval chord = sqrt(square(run) + square(rise));
  if (!(chord.lower() > 0.0)) return infinity;
  // Between its ends the curve falls: it leaves the chord by no more than the box of both ends does.
  const double by_box = (run * rise / chord).upper();
  // Its points satisfy n·p <= h(n) for the chord's normal n = (rise, run). Here h is the dual norm, which rises with
  // each operand.
  const Interval across = rise * Interval(width);
  const Interval along = run * Interval(height);
  const double support = norm_of(across.upper(), along.upper(), dual_, Direction::up);
  const Interval at_end = across * from.x + along * from.y;
  const double by_support = ((Interval(support) - at_end) / chord).upper();
  return std::max(0.0, std::min(by_box, by_support));
}

namespace {

struct Tangent {
  Interval along;    ///< the chord, per length of the tangent
  Interval tangent;  ///< tangent of the angle with the chord, unsigned
  PlaneVector speed;
};

std::optional<Tangent> tangent_over(const PlaneVector& direction, const PlaneVector& chord, const Interval& length) {
  const auto& [x, y] = direction;
  const Interval size = sqrt(square(x) + square(y));
  const Interval forward = (x * chord[0] + y * chord[1]) / length;
  if (!(size.lower() > 0.0) || !(forward.lower() > 0.0)) return std::nullopt;
  const Interval aside = abs(x * chord[1] - y * chord[0]) / length;
  // The foot passes the chord, of this length, while u goes from 0 to 1.
  const Interval by_share = length / forward;
  return Tangent{forward / size, aside / forward, {x * by_share, y * by_share}};
}

/// Nothing unless both tangents are proven to point forward along the chord.
std::optional<ArcBounds> bounds_of(const PlaneArc& arc) {
  const PlaneVector chord{arc.to[0] - arc.from[0], arc.to[1] - arc.from[1]};
  const Interval length = sqrt(square(chord[0]) + square(chord[1]));
  if (!(length.lower() > 0.0)) return std::nullopt;
  const auto first = tangent_over(arc.tangent_from, chord, length);
  const auto last = tangent_over(arc.tangent_to, chord, length);
  if (!first || !last) return std::nullopt;
  // Between its ends the tangent turns from one to the other, and so its angle with the chord is no larger.
  const double steepest = std::max(first->tangent.upper(), last->tangent.upper());
  const double least_along = std::min(first->along.lower(), last->along.lower());
  if (!(least_along > 0.0)) return std::nullopt;
  const double longest = (Interval(1) / Interval(least_along)).upper();
  return ArcBounds{length,
                   {1.0, std::max(1.0, longest)},
                   {0.0, (square(length) * Interval(steepest) / Interval(4)).upper()},
                   (length * Interval(steepest) / Interval(2)).upper(),
                   {hull(first->speed[0], last->speed[0]), hull(first->speed[1], last->speed[1])}};
}

constexpr double no_bound = std::numeric_limits<double>::infinity();

/// No less than the integral of |v| over the integral of v's length along e. All v lie in the cone of these four
/// directions, whose first components are not negative; e is their middle. Infinite if the cone is wide.
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

/// The factors by which the taper widens the sections at both ends of the profile; in between, the factor is between
/// these.
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

double PatchedSurface::largest_area(const PatchCell& cell, const PlaneArc& along, const PlaneArc& around,
                                    const Interval& widest) const {
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
  return (Interval(1.5) * largest_s * largest_c * way_around * way_along * Interval(bend_map_ ? 2 : 1)).upper();
}

PatchArea PatchedSurface::area(const PatchCell& cell) const {
  const std::array<Placed, 4> corners = this->corners(cell);
  const Interval widest(section_radius(cell));  // of β
  const PlaneArc along = profile(cell, widest);
  const PlaneArc around = section(cell);
  const std::optional<ArcBounds> of_profile = bounds_of(along);
  const std::optional<ArcBounds> of_section = bounds_of(around);
  const PatchArea coarse{{0.0, largest_area(cell, along, around, widest)}, no_bound, no_bound};
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
  // Arcs that may overlap their neighbours count with 0 from below: the overlap may be counted there.
  const bool is_apart = along_.in_order(cell.along) && around_.in_order(cell.around);
  const Enclosure area{is_apart ? std::max(0.0, size.lower()) : 0.0, std::min(upper, coarse.area.hi)};

  const Interval density =
      scale / widest * length * sqrt(square(stretch * of_profile->speed[1]) + square(support * of_profile->speed[0]));
  const double spread = (density - Interval(std::max(0.0, density.lower()))).upper();
  return {area, area.lo > 0.0 ? (Interval(spread) / Interval(area.lo)).upper() : no_bound,
          flat_thickness(straight, corners)};
}

namespace {

double upper_length(const Vector3<double>& v) {
  return length<double>(v).upper();
}

Point middle_of(const Vector3<double>& box) {
  Point middle;
  for (std::size_t i = 0; i < 3; ++i) middle[i] = 0.5 * box[i].lower() + 0.5 * box[i].upper();
  return middle;
}

Vector3<double> exact(const Point& point) {
  return {point[0], point[1], point[2]};
}

/// Upper bound of the distance of the box's points from its middle.
double blur(const Vector3<double>& box, const Point& middle) {
  return upper_length(box - exact(middle));
}

/// Upper bound of the distance of the corners' bilinear surface from the two triangles: μ (1 - λ) <= 1/4 times the
/// corners' deviation from a parallelogram, where μ <= λ.
double unevenness(const std::array<Point, 4>& corners) {
  const auto& [a, b, c, d] = corners;
  return (length<double>(exact(a) - exact(b) - exact(c) + exact(d)) / Interval(4)).upper();
}

double sum_up(double a, double b) {
  return add(a, b, Direction::up);
}

Interval greater(const Interval& a, const Interval& b) {
  return {std::max(a.lower(), b.lower()), std::max(a.upper(), b.upper())};
}

}  // namespace

PatchedSurface::PatchedSurface(const Primitive& primitive, std::uint32_t index)
    : index_(index),
      superquadric_(primitive.superquadric),
      semi_axes_(superquadric_.semi_axes[0], superquadric_.semi_axes[1], superquadric_.semi_axes[2]),
      tapered_(is_tapered(superquadric_)),
      k_(TaperNumbers<double>(superquadric_.taper).k),
      fall_(TaperNumbers<double>(superquadric_.taper).fall),
      along_(superquadric_.exponents[0]),
      around_(superquadric_.exponents[1]) {
  if (is_bent(primitive)) {
    bend_ = primitive.bend;
    bend_map_.emplace(*bend_);
  }
  const RigidMotion motion(primitive.pose);
  rotation_ = in_binary64(motion.rotation);
  translation_ = in_binary64(motion.translation);
}

std::vector<PatchCell> PatchedSurface::octants() const {
  std::vector<PatchCell> octants;
  for (std::uint8_t octant = 0; octant < 8; ++octant) octants.push_back({.primitive = index_, .octant = octant});
  return octants;
}

PatchedSurface::Placed PatchedSurface::placed(const CurvePoint& along, const CurvePoint& around,
                                              std::uint8_t octant) const {
  Vector3<double> x(along.x * around.x, along.x * around.y, along.y);
  for (std::size_t i = 0; i < 3; ++i) {
    if ((octant >> i & 1U) != 0) x[i] = -x[i];
  }
  if (tapered_) {
    // (x, y, ζ) -> (s x, s y, (ζ - k) / (1 - k ζ)), s = (1 - k²) / (1 - k ζ); docs/mathematics.md §18
    const Interval fall = Interval(1) - k_ * x[2];
    const Interval scale = fall_ / fall;
    x = {x[0] * scale, x[1] * scale, (x[2] - k_) / fall};
  }
  for (std::size_t i = 0; i < 3; ++i) x[i] = x[i] * semi_axes_[i];
  return {x, rotation_ * (bend_map_ ? bend_map_->bent(x) : x) + translation_};
}

double PatchedSurface::section_radius(const PatchCell& cell) const {
  const auto radius = [&](const CurvePoint& p) {
    return sqrt(square(p.x * semi_axes_[0]) + square(p.y * semi_axes_[1])).upper();
  };
  return std::max(radius(around_.from(cell.around)), radius(around_.to(cell.around)));
}

/// A Lipschitz constant of the taper's map over the heights of the cell, for points no farther than `reach` from the
/// axis: the norm of its derivative is at most max(s, dζ'/dζ) + |(x, y)| |ds/dz|.
Interval PatchedSurface::taper_stretch(const PatchCell& cell, double reach) const {
  Interval height = hull(along_.from(cell.along).y, along_.to(cell.along).y);
  if ((cell.octant & 4U) != 0) height = -height;
  const Interval fall = Interval(1) - k_ * height;
  const Interval scale = fall_ / fall;
  const Interval slope = scale / fall;
  return greater(scale, slope) + Interval(reach) * slope * abs(k_) / semi_axes_[2];
}

Interval PatchedSurface::straight_thickness(const PatchCell& cell) const {
  const double widest = std::max(along_.from(cell.along).x.upper(), along_.to(cell.along).x.upper());
  const double section = section_radius(cell);
  const double of_section = multiply(
      widest, around_.bulge(cell.around, superquadric_.semi_axes[0], superquadric_.semi_axes[1]), Direction::up);
  Interval thickness(sum_up(of_section, along_.bulge(cell.along, section, superquadric_.semi_axes[2])));
  if (tapered_) thickness *= taper_stretch(cell, sum_up(multiply(widest, section, Direction::up), of_section));
  return thickness;
}

Interval PatchedSurface::bent_thickness(const Interval& straight, const std::array<Placed, 4>& corners) const {
  if (!bend_map_) return straight;
  // The corners' hull and the patch lie in the solid, where |k r| < 1, so that the bend stretches by at most 1 + |k r|
  // < 2. Its second derivative is at most 2 |k|. So a point of the hull, Σ λ w, goes no farther than |k| Σ λ |w - c|²
  // from the hull of the bent corners, for any c.
  const Point centre =
      middle_of((corners[0].straight + corners[1].straight + corners[2].straight + corners[3].straight) / Interval(4));
  double radius = 0.0;
  double reach = 0.0;
  for (const Placed& corner : corners) {
    radius = std::max(radius, upper_length(corner.straight - exact(centre)));
    reach = std::max(reach, sqrt(square(corner.straight[0]) + square(corner.straight[1])).upper());
  }
  const Interval curvature = abs(Interval(bend_->curvature));
  const Interval stretch = Interval(1) + curvature * (Interval(reach) + straight);
  return straight * Interval(std::min(2.0, stretch.upper())) + curvature * square(Interval(radius));
}

void PatchedSurface::prepare(const PatchCell& cell) {
  along_.halve(cell.along);
  around_.halve(cell.around);
}

std::array<PatchedSurface::Placed, 4> PatchedSurface::corners(const PatchCell& cell) const {
  const std::array<CurvePoint, 2> along{along_.from(cell.along), along_.to(cell.along)};
  const std::array<CurvePoint, 2> around{around_.from(cell.around), around_.to(cell.around)};
  return {placed(along[0], around[0], cell.octant), placed(along[0], around[1], cell.octant),
          placed(along[1], around[0], cell.octant), placed(along[1], around[1], cell.octant)};
}

double PatchedSurface::flat_thickness(const Interval& straight, const std::array<Placed, 4>& corners) const {
  std::array<Point, 4> rounded{};
  double blurred = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    rounded[i] = middle_of(corners[i].posed);
    blurred = std::max(blurred, blur(corners[i].posed, rounded[i]));
  }
  return sum_up(sum_up(bent_thickness(straight, corners).upper(), blurred), unevenness(rounded));
}

/// Flat triangles are farthest from x at a corner, and the patch is no farther from them than it is thick.
double Patch::radius_about(const Point& x) const {
  double farthest = 0.0;
  for (const Point& corner : corners) farthest = std::max(farthest, upper_length(exact(corner) - exact(x)));
  return sum_up(farthest, thickness);
}

Patch PatchedSurface::patch(const PatchCell& cell) const {
  const std::array<Placed, 4> corners = this->corners(cell);
  Patch patch{};
  patch.sample = middle_of(placed(along_.middle(cell.along), around_.middle(cell.around), cell.octant).posed);
  for (std::size_t i = 0; i < corners.size(); ++i) patch.corners[i] = middle_of(corners[i].posed);
  patch.thickness = flat_thickness(straight_thickness(cell), corners);
  patch.radius = patch.radius_about(patch.sample);
  return patch;
}

std::optional<PatchHalving> PatchedSurface::halving(const PatchCell& cell) const {
  if (cell.halvings == most_halvings_of_patch) return std::nullopt;
  const CurvePoint& low = along_.from(cell.along);
  const CurvePoint& high = along_.to(cell.along);
  const CurvePoint& left = around_.from(cell.around);
  const CurvePoint& right = around_.to(cell.around);
  const double widest = std::max(low.x.upper(), high.x.upper());
  const auto apart = [](const Interval& a, const Interval& b, double scale) {
    return scale * (0.5 * (a.lower() + a.upper()) - 0.5 * (b.lower() + b.upper()));
  };
  const auto& axes = superquadric_.semi_axes;
  const double way_along = std::hypot(apart(low.x, high.x, section_radius(cell)), apart(low.y, high.y, axes[2]));
  const double way_around = widest * std::hypot(apart(left.x, right.x, axes[0]), apart(left.y, right.y, axes[1]));
  const bool divide_along = way_along >= way_around;
  // If neighbours differ by rounding only, their bulge means nothing.
  const double share = divide_along ? std::hypot(apart(low.x, high.x, 1.0), apart(low.y, high.y, 1.0))
                                    : std::hypot(apart(left.x, right.x, 1.0), apart(left.y, right.y, 1.0));
  if (!(share > 0x1p-30)) return std::nullopt;
  return divide_along ? PatchHalving::along : PatchHalving::around;
}

/// The halves of an arc cover it, wherever its middle was rounded to (ArcTree::halve). Hence the halves of the patch
/// cover it.
std::array<PatchCell, 2> PatchedSurface::halves(const PatchCell& cell, PatchHalving halving) const {
  const bool is_along = halving == PatchHalving::along;
  std::array<PatchCell, 2> halves{cell, cell};
  const ArcTree::Arc first = is_along ? along_.first_half(cell.along) : around_.first_half(cell.around);
  for (std::uint32_t i = 0; i < 2; ++i) {
    (is_along ? halves[i].along : halves[i].around) = first + i;
    ++halves[i].halvings;
  }
  return halves;
}

std::optional<std::array<PatchCell, 2>> PatchedSurface::halves(const PatchCell& cell) const {
  const std::optional<PatchHalving> way = halving(cell);
  if (!way) return std::nullopt;
  return halves(cell, *way);
}

}  // namespace verisq::verify
