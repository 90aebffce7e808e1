/// What each step from the unit surface to the model does to hull and thickness. The derivations stand in
/// docs/mathematics.md §20.
#include "verify/deviation/surface_patch.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/in_binary64.hpp"
#include "verify/proof/rigid_motion.hpp"
#include "verify/proof/superquadric.hpp"

namespace verisq::verify {

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

/// How far the box's points lie from its middle, at most.
double blur(const Vector3<double>& box, const Point& middle) {
  return upper_length(box - exact(middle));
}

/// How far the bilinear surface of the corners lies from the two triangles, at most: μ (1 - λ) <= 1/4 times what the
/// corners are from a parallelogram, where μ <= λ.
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
  // The corners' hull and the patch lie in the solid, where |k r| < 1, so that the bend stretches by at most 1 + |k
  // r| < 2. Its second derivative is at most 2 |k|: a point of the hull, Σ λ w, goes no farther than |k| Σ λ |w - c|²
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
  // Where neighbours differ by rounding only, their bulge says nothing.
  const double share = divide_along ? std::hypot(apart(low.x, high.x, 1.0), apart(low.y, high.y, 1.0))
                                    : std::hypot(apart(left.x, right.x, 1.0), apart(left.y, right.y, 1.0));
  if (!(share > 0x1p-30)) return std::nullopt;
  return divide_along ? PatchHalving::along : PatchHalving::around;
}

/// The halves of an arc cover it, wherever its middle was rounded to (ArcTree::halve), hence those of the patch.
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
