/// Chords between the ends of a section, for any slope.
#include "verify/pairs/posed_sections.hpp"

#include <algorithm>

#include "verify/proof/trigonometry.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

Bend bend_of(const Primitive& primitive) {
  return is_bent(primitive) ? *primitive.bend : Bend{0.0, 0.0};
}

}  // namespace

PosedSections::PosedSections(const Primitive& primitive)
    : bounds_(primitive.superquadric),
      focus_(focus(primitive.superquadric)),
      motion_(primitive.pose),
      half_length_(primitive.superquadric.semi_axes[2]),
      curvature_(Real(bend_of(primitive).curvature)),
      cosine_(cosine_of_degrees(bend_of(primitive).angle_degrees)),
      sine_(sine_of_degrees(bend_of(primitive).angle_degrees)),
      extent_(std::max(bounds_.support_up({cosine_, sine_, 0}), bounds_.support_up({-cosine_, -sine_, 0}))) {}

/// (x, y, z) -> (r, s, z): r along the bend.
PreciseVector PosedSections::turned(const PreciseVector& n) const {
  return {n[0] * cosine_ + n[1] * sine_, n[1] * cosine_ - n[0] * sine_, n[2]};
}

Real PosedSections::reach(const PreciseVector& n, const Section& section, double slope) const {
  if (curvature_.lower() == Real(0) && curvature_.upper() == Real(0)) {
    return (PreciseInterval(bounds_.support_up(n)) + n.dot(focus_)).upper();
  }
  const PreciseVector m = turned(n);
  const PreciseInterval v{Real(slope)};
  Real at_ends(-infinity);
  Real least_curving(infinity);  // of k c
  for (const double height : {section.lower, section.upper}) {
    const PreciseInterval z{Real(height)};
    const PreciseInterval angle = curvature_ * z;
    const PreciseInterval half = angle / PreciseInterval(2);
    const PreciseInterval axis = z * (m[0] * sine_of(half) * quotient_of_sine(half) + m[2] * quotient_of_sine(angle));
    const PreciseInterval c = m[0] * cosine_of(angle) - m[2] * sine_of(angle);
    const PreciseVector direction{c * cosine_ - m[1] * sine_, c * sine_ + m[1] * cosine_, v};
    const PreciseInterval support(bounds_.support_up(direction));
    at_ends = std::max(at_ends, (axis + support + v * (focus_[2] - z)).upper());
    least_curving = std::min(least_curving, (curvature_ * c).lower());
  }
  const PreciseInterval between = PreciseInterval(Real(section.upper)) - PreciseInterval(Real(section.lower));
  const PreciseInterval eighth = square(between) / PreciseInterval(8);
  // c'' = -k² c and |c| <= |(n_R, n_Z)|: the most that c leaves its chord, and so its ends.
  const PreciseInterval c_off = square(curvature_) * sqrt(square(m[0]) + square(m[2])) * eighth;
  const Real concave = (abs(curvature_) * c_off - PreciseInterval(least_curving)).upper();
  const PreciseInterval e_off = PreciseInterval(std::max(Real(0), concave)) * eighth;
  return (PreciseInterval(at_ends) + e_off + extent_ * c_off).upper();
}

std::optional<std::array<PosedSections::Section, 2>> halves(const PosedSections::Section& section) {
  const double middle = 0.5 * section.lower + 0.5 * section.upper;
  if (!(middle > section.lower && middle < section.upper)) return std::nullopt;
  return std::array{PosedSections::Section{section.lower, middle}, PosedSections::Section{middle, section.upper}};
}

}  // namespace verisq::verify
