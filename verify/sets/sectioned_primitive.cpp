/// Chords between the ends of a section, for any slope.
#include "verify/sets/sectioned_primitive.hpp"

#include <algorithm>
#include <cmath>

#include "verify/analysis/in_binary64.hpp"
#include "verify/analysis/trigonometry.hpp"
#include "verify/sets/bend_range.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

SectionMapping::End about(const SectionedPrimitive::End& end) {
  return {end.height, middle(end.cosine), middle(end.sine), middle(end.along), middle(end.up)};
}

SectionMapping::Section about(const SectionedPrimitive::Section& section) {
  return {about(section.lower), about(section.upper)};
}

}  // namespace

SectionedPrimitive::SectionedPrimitive(const Primitive& primitive)
    : half_length_(primitive.superquadric.semi_axes[2]),
      bounds_(primitive.superquadric),
      focus_(in_binary64(focus(primitive.superquadric)[2])),
      mapping_(primitive) {
  if (!is_bent(primitive)) return;
  curvature_ = primitive.bend->curvature;
  map_.emplace(*primitive.bend);
  extent_ = extent(*primitive.bend, primitive.superquadric).upper().to_double(Direction::up);
}

SectionedPrimitive::End SectionedPrimitive::end_at(double height) const {
  const Interval z(height);
  if (!map_) return {height, 1, 0, 0, z};
  const Interval angle = Interval(curvature_) * z;
  const Interval half = angle / Interval(2);
  return {height, cos(angle), sin(angle), z * sin(half) * sine_quotient(half), z * sine_quotient(angle)};
}

SectionedPrimitive::Section SectionedPrimitive::whole() const {
  return {end_at(-half_length_), end_at(half_length_)};
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

double SectionedPrimitive::slope(const Coordinates<double>& direction, const Section& section) const {
  return mapping_.slope(direction, about(section));
}

Coordinates<double> SectionedPrimitive::support_point(const Coordinates<double>& direction,
                                                      const Section& section) const {
  return mapping_.support_point(direction, about(section));
}

double SectionedPrimitive::support_up(const Vector3<double>& direction, const Section& section) const {
  if (!map_) return (Interval(bounds_.support_up(direction)) + direction[2] * focus_).upper();
  const Vector3<double> n = map_->turned(direction);
  const double chosen = slope({middle(direction[0]), middle(direction[1]), middle(direction[2])}, section);
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
