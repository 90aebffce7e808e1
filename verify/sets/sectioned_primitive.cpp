/// Chords between the ends of a section, for any slope; fixed points propose the slope and the farthest point.
#include "verify/sets/sectioned_primitive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/analysis/in_binary64.hpp"
#include "verify/analysis/trigonometry.hpp"
#include "verify/sets/bend_range.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr int kMostFixedPoints = 6;

double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

Superquadric without_taper(Superquadric solid) {
  solid.taper = 1.0;
  return solid;
}

/// (1 - |z|^p)^(1/p)
double profile(double z, double p) {
  return std::pow(std::max(0.0, 1.0 - std::pow(std::fabs(z), p)), 1.0 / p);
}

double slope_of_profile(double z, double p) {
  return -std::copysign(std::pow(std::fabs(z) / profile(z, p), p - 1.0), z);
}

double sine_quotient_of(double angle) {
  return angle == 0.0 ? 1.0 : std::sin(angle) / angle;
}

}  // namespace

SectionedPrimitive::SectionedPrimitive(const Primitive& primitive)
    : superquadric_(primitive.superquadric),
      bounds_(primitive.superquadric),
      focus_(in_binary64(focus(primitive.superquadric)[2])),
      taper_(taper_coefficient<double>(primitive.superquadric.taper)),
      unbent_(primitive.superquadric),
      untapered_(without_taper(primitive.superquadric)) {
  if (!is_bent(primitive)) return;
  curvature_ = primitive.bend->curvature;
  map_.emplace(*primitive.bend);
  extent_ = extent(*primitive.bend, superquadric_).upper().to_double(Direction::up);
  cosine_ = middle(map_->direction()[0]);
  sine_ = middle(map_->direction()[1]);
}

SectionedPrimitive::End SectionedPrimitive::end_at(double height) const {
  const Interval z(height);
  if (!map_) return {height, 1, 0, 0, z};
  const Interval angle = Interval(curvature_) * z;
  const Interval half = angle / Interval(2);
  return {height, cos(angle), sin(angle), z * sin(half) * sine_quotient(half), z * sine_quotient(angle)};
}

SectionedPrimitive::Section SectionedPrimitive::whole() const {
  const double a3 = superquadric_.semi_axes[2];
  return {end_at(-a3), end_at(a3)};
}

std::optional<std::array<SectionedPrimitive::Section, 2>> SectionedPrimitive::halves(const Section& section) const {
  const double height = 0.5 * section.lower.height + 0.5 * section.upper.height;
  if (!map_ || !(height > section.lower.height && height < section.upper.height)) return std::nullopt;
  const End between = end_at(height);
  return std::array{Section{section.lower, between}, Section{between, section.upper}};
}

double SectionedPrimitive::slack(const Section& section) const {
  const double between = section.upper.height - section.lower.height;
  const double k = std::fabs(curvature_);
  return k * (1.0 + k * extent_) * between * between / 8.0;
}

// --- Proposals ---

SectionedPrimitive::Plain SectionedPrimitive::turned(const Plain& v) const {
  return {v[0] * cosine_ + v[1] * sine_, v[1] * cosine_ - v[0] * sine_, v[2]};
}

SectionedPrimitive::Plain SectionedPrimitive::turned_back(const Plain& v) const {
  return {v[0] * cosine_ - v[1] * sine_, v[0] * sine_ + v[1] * cosine_, v[2]};
}

SectionedPrimitive::Plain SectionedPrimitive::bent(const Plain& unbent) const {
  const double angle = curvature_ * unbent[2];
  return {unbent[0] * std::cos(angle) + unbent[2] * std::sin(angle / 2) * sine_quotient_of(angle / 2), unbent[1],
          (1.0 - curvature_ * unbent[0]) * unbent[2] * sine_quotient_of(angle)};
}

/// Of the unbent solid towards (c, across, slope), in the frame of the bend.
SectionedPrimitive::Plain SectionedPrimitive::farthest(double c, double across, double slope) const {
  Plain x = turned(unbent_(turned_back({c, across, slope})));
  x[2] -= taper_ * superquadric_.semi_axes[2];
  return x;
}

/// The same within the section at a height.
SectionedPrimitive::Plain SectionedPrimitive::farthest_at(double height, double c, double across) const {
  const Plain x = turned(untapered_(turned_back({c, across, 0.0})));
  const double scale = scale_at(height);
  return {scale * x[0], scale * x[1], height};
}

/// How large the section at a height is, for one of the solid without a taper's middle (docs/mathematics.md §18).
double SectionedPrimitive::scale_at(double height) const {
  const double z = std::clamp(height / superquadric_.semi_axes[2], -1.0, 1.0);
  const double s = 1.0 + taper_ * z;
  return s * profile((z + taper_) / s, 2.0 / superquadric_.exponents[0]);
}

double SectionedPrimitive::scale_slope_at(double height) const {
  const double z = height / superquadric_.semi_axes[2];
  const double s = 1.0 + taper_ * z;
  const double unbent = (z + taper_) / s;
  const double p = 2.0 / superquadric_.exponents[0];
  const double slope = taper_ * profile(unbent, p) + slope_of_profile(unbent, p) * (1.0 - taper_ * taper_) / s;
  return slope / superquadric_.semi_axes[2];
}

/// In the frame of the bend: the ends have the same value, unless the height where H - v z is attained would leave the
/// section.
double SectionedPrimitive::slope_towards(const Plain& n, const Section& section) const {
  const auto& [lower, upper] = section;
  const auto axis = [&](const End& end) { return n[0] * middle(end.along) + n[2] * middle(end.up); };
  const auto along = [&](const End& end) { return n[0] * middle(end.cosine) - n[2] * middle(end.sine); };
  const double rise = axis(upper) - axis(lower);
  const double between = upper.height - lower.height;
  const double c_lower = along(lower);
  const double c_upper = along(upper);
  double v = rise / between;
  double height = 0.0;
  for (int i = 0; i < 2; ++i) {
    const Plain x = farthest(0.5 * (c_lower + c_upper), n[1], v);
    height = x[2];
    v = (rise + (c_upper - c_lower) * x[0]) / between;
  }
  if (height >= lower.height && height <= upper.height) return v;
  const End& end = height < lower.height ? lower : upper;
  const Plain x = turned(untapered_(turned_back({along(end), n[1], 0.0})));
  const double at_end = -scale_slope_at(end.height) * (along(end) * x[0] + n[1] * x[1]);
  return std::isfinite(at_end) ? at_end : v;  // at a pole, which no height is beyond
}

double SectionedPrimitive::slope(const Coordinates<double>& direction, const Section& section) const {
  return map_ ? slope_towards(turned(direction), section) : 0.0;
}

Coordinates<double> SectionedPrimitive::support_point(const Coordinates<double>& direction,
                                                      const Section& section) const {
  const Plain n = turned(direction);
  if (!map_) return turned_back(farthest(n[0], n[1], n[2]));
  Plain best{};
  double reach = -infinity;
  const auto try_point = [&](const Plain& unbent) {
    const Plain image = bent(unbent);
    const double found = dot(n, image);
    if (found > reach) best = image;
    reach = std::max(reach, found);
  };
  double height = 0.5 * section.lower.height + 0.5 * section.upper.height;
  double before = height;
  double r = 0.0;
  for (int i = 0; i < kMostFixedPoints; ++i) {
    const double cosine = std::cos(curvature_ * height);
    const double sine = std::sin(curvature_ * height);
    const double c = n[0] * cosine - n[2] * sine;
    Plain x = farthest(c, n[1], (n[0] * sine + n[2] * cosine) * (1.0 - curvature_ * r));
    const double next = std::clamp(x[2], section.lower.height, section.upper.height);
    if (next != x[2]) x = farthest_at(next, c, n[1]);
    try_point(x);
    r = x[0];
    before = std::exchange(height, next);
    if (std::fabs(height - before) <= 0x1p-50 * superquadric_.semi_axes[2]) return turned_back(best);
  }
  // Between two corners, perhaps, which take turns.
  const double between = 0.5 * (height + before);
  const double c = n[0] * std::cos(curvature_ * between) - n[2] * std::sin(curvature_ * between);
  try_point(farthest_at(between, c, n[1]));
  return turned_back(best);
}

// --- The proof ---

double SectionedPrimitive::support_up(const Vector3<double>& direction, const Section& section) const {
  if (!map_) return (Interval(bounds_.support_up(direction)) + direction[2] * focus_).upper();
  const Vector3<double> n = map_->turned(direction);
  const double chosen = slope_towards({middle(n[0]), middle(n[1]), middle(n[2])}, section);
  if (!std::isfinite(chosen)) return infinity;
  const Interval v(chosen);
  const Vector3<double> r = map_->direction();
  double largest = -infinity;
  Interval c_of_both;
  for (const End* const end : {&section.lower, &section.upper}) {
    const Interval c = n[0] * end->cosine - n[2] * end->sine;
    const Interval support(bounds_.support_up({c * r[0] - n[1] * r[1], c * r[1] + n[1] * r[0], v}));
    const Interval axis = n[0] * end->along + n[2] * end->up;
    largest = std::max(largest, (axis + support + v * (focus_ - Interval(end->height))).upper());
    c_of_both = end == &section.lower ? c : hull(c_of_both, c);
  }
  const Interval k(curvature_);
  const Interval between = Interval(section.upper.height) - Interval(section.lower.height);
  const Interval eighth = square(between) / Interval(8);
  // |c| <= |(n_R, n_Z)|: the most that c leaves its chord, and so its ends.
  const Interval c_off = square(k) * sqrt(square(n[0]) + square(n[2])) * eighth;
  const Interval signed_c = curvature_ > 0.0 ? c_of_both : -c_of_both;
  const Interval concave(std::max(0.0, (c_off - signed_c).upper()));
  return (Interval(largest) + abs(k) * concave * eighth + Interval(extent_) * c_off).upper();
}

}  // namespace verisq::verify
