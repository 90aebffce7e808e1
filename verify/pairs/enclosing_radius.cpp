/// One multiplier serves for every point of an ellipsoid.
#include "verify/pairs/enclosing_radius.hpp"

#include <algorithm>
#include <cmath>

#include "verify/proof/rigid_motion.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

/// 2^(1/2 - 1/p), at least 1, for p = 2/e.
PreciseInterval excess_of_norm(double exponent) {
  if (exponent >= 1.0) return 1;
  const PreciseInterval half = PreciseInterval(1) / PreciseInterval(2);
  return pow(PreciseInterval(2), half * (PreciseInterval(1) - PreciseInterval(Real(exponent))));
}

}  // namespace

bool is_ball(const Primitive& primitive) {
  const auto& [axes, exponents, taper] = primitive.superquadric;
  return axes[0] == axes[1] && axes[1] == axes[2] && exponents == std::array{1.0, 1.0} && taper == 1.0 &&
         !is_bent(primitive);
}

std::array<double, 3> semi_axes_of_ellipsoid(const Superquadric& solid) {
  const PreciseInterval whole = excess_of_norm(solid.exponents[0]);
  const PreciseInterval section = whole * excess_of_norm(solid.exponents[1]);
  const auto up = [](const PreciseInterval& scale, double axis) {
    return (scale * PreciseInterval(Real(axis))).upper().to_double(Direction::up);
  };
  return {up(section, solid.semi_axes[0]), up(section, solid.semi_axes[1]), up(whole, solid.semi_axes[2])};
}

double farthest_up(const Primitive& primitive, const PreciseVector& x, double multiplier) {
  if (is_bent(primitive) || is_tapered(primitive.superquadric)) return infinity;
  const RigidMotion motion(primitive.pose);
  const PreciseVector from_centre = x - motion.translation;
  if (is_ball(primitive)) {
    const PreciseInterval radius{Real(primitive.superquadric.semi_axes[0])};
    return (length<Real>(from_centre) + radius).upper().to_double(Direction::up);
  }
  const PreciseVector c = motion.rotation.transpose() * from_centre;
  const std::array<double, 3> b = semi_axes_of_ellipsoid(primitive.superquadric);
  if (!std::isfinite(multiplier) || !std::ranges::all_of(b, [](double axis) { return std::isfinite(axis); })) {
    return infinity;
  }
  const PreciseInterval mu{Real(multiplier)};
  PreciseInterval squared = mu;
  for (std::size_t i = 0; i < 3; ++i) {
    const PreciseInterval room = mu - square(PreciseInterval(Real(b[i])));
    if (!(room.lower() > Real(0))) return infinity;
    squared += square(c[i]) * mu / room;
  }
  return sqrt(squared).upper().to_double(Direction::up);
}

}  // namespace verisq::verify
