/// This file implements the enclosed constants of a primitive: exponents, rotation, radii.
#include "host/batches/primitive_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "host/batches/directed_conversion.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::device {
namespace {

constexpr double unit_roundoff = 0x1p-53;

// An integer power of two above which (1 + t^q)^(1/q) is the maximum norm to far below rounding; as a lower bound of
// an exponent it is always valid, since norms fall as exponents rise.
constexpr double largest_conjugate = 0x1p60;

void set_exponents(PrimitiveParameters& out, const std::array<double, 2>& exponents) {
  for (int i = 0; i < 2; ++i) {
    const Extended e(exponents[i]);
    const Extended p = 2 / e;
    out.p[i] = p.convert_to<double>();
    out.p_down[i] = round_down(p);
    out.inverse_p[i] = exponents[i] / 2;
    out.inverse_p_up[i] = exponents[i] / 2;  // exact but for subnormal exponents
    if (Extended(out.inverse_p_up[i]) * 2 < e) out.inverse_p_up[i] = std::nextafter(out.inverse_p_up[i], infinity);
    const bool is_maximum = exponents[i] == 2.0;
    out.conjugate_down[i] = is_maximum ? largest_conjugate : std::min(round_down(2 / (2 - e)), largest_conjugate);
    out.inverse_conjugate_up[i] = round_up(std::max(Extended(2 - e) / 2, Extended(1 / largest_conjugate)));
  }
}

// Norms of two numbers fall with the exponent, ||w||_p <= ||w||_p_down <= 2^(1/p_down - 1/p) ||w||_p, so the gauge with
// p_down is at most 2^d times the exact one, d = sum of 1/p_down - 1/p over both exponents, and 1/p = e/2. And
// 2^d <= 1 + d for d in [0, 1].
void set_containment(PrimitiveParameters& out, const std::array<double, 2>& exponents) {
  Extended d = 0;
  for (int i = 0; i < 2; ++i) {
    const Extended difference = (2 - Extended(exponents[i]) * out.p_down[i]) / (2 * Extended(out.p_down[i]));
    if (difference > 0) d += difference;
  }
  out.containment_up = d == 0 ? 1.0 : round_up(1 + d * (1 + Extended(0x1p-100)));  // quotients are rounded
}

// Each entry is the exact one rounded once.
void set_rotation(PrimitiveParameters& out, const std::array<double, 4>& quaternion) {
  const std::array<Extended, 9> rotation = rotation_to_local(quaternion);
  std::transform(rotation.begin(), rotation.end(), std::begin(out.rotation),
                 [](const Extended& entry) { return entry.convert_to<double>(); });
}

// Bound of |computed - exact local point| / |x - translation|_1. Each component of the local point is a sum of three
// products R_ij d_j whose factors carry one rounding each and which pass through at most three more; columns of R have
// length 1, so the error vector is at most ((1 + u)^5 - 1) |d|_1 < 5.01 u |d|_1.
double pose_error(const PrimitiveParameters& out) {
  const bool permutes = std::all_of(std::begin(out.rotation), std::end(out.rotation),
                                    [](double entry) { return entry == 0.0 || std::abs(entry) == 1.0; });
  const bool stays = std::all_of(std::begin(out.translation), std::end(out.translation),
                                 [](double component) { return component == 0.0; });
  if (!permutes) return 5.1 * unit_roundoff;
  return stays ? 0.0 : 1.1 * unit_roundoff;  // only x - translation is rounded
}

void set_radii(PrimitiveParameters& out, const std::array<double, 2>& exponents) {
  Extended squares = 0;
  Extended inverse_squares = 0;
  for (const double axis : out.semi_axes) {
    squares += Extended(axis) * axis;
    inverse_squares += 1 / (Extended(axis) * axis);
  }
  // Exponents up to 1: the solid contains the ellipsoid; always: the octahedron of its axes.
  const bool contains_ellipsoid = exponents[0] <= 1.0 && exponents[1] <= 1.0;
  out.inradius_down = contains_ellipsoid ? *std::min_element(std::begin(out.semi_axes), std::end(out.semi_axes))
                                         : round_down(1 / sqrt(inverse_squares));
  out.circumradius_up = round_up(sqrt(squares) * (1 + Extended(0x1p-100)));
}

// The greatest |(x, y)| with ||(x/a, y/b)||_p <= 1, p = 2/e: by Hoelder's inequality for squares, whose exponent is
// p/2, the norm of (a, b) with exponent 2 p/(p - 2) = 2/(1 - e); for p <= 2 the greater of both.
Extended reach(const Extended& a, const Extended& b, double e) {
  const Extended greater = std::max(a, b);
  if (e >= 1.0) return greater;
  const Extended half = (1 - Extended(e)) / 2;
  return greater * pow(1 + pow(std::min(a, b) / greater, 1 / half), half);
}

// |(x, y)| is at most the section's reach times its norm.
void set_reach(PrimitiveParameters& out, const std::array<double, 2>& exponents) {
  const Extended section = reach(out.semi_axes[0], out.semi_axes[1], exponents[1]);
  out.reach_up = round_up(reach(section, out.semi_axes[2], exponents[0]) * (1 + Extended(0x1p-100)));
}

// With k' the rounded k, a point of the solid, ((1 + k z) x, (1 + k z) y, a3 z) with z = (Z - k)/(1 - k Z), moves with
// k along z by a3 (1 - Z^2)/(1 - k Z)^2 <= a3/(1 - k^2), and across by |(a1, a2)| |z + k dz/dk| <= |(a1, a2)| (1 +
// |k|/(1 - k^2)), per unit of k: between k and k', at most |k - k'| times their sum for the greater of both. The
// distances of convex sets of which each point has one of the other within that, and those about a rounded focus,
// differ by no more.
void set_taper(PrimitiveParameters& out, double ratio) {
  const Extended k = (Extended(ratio) - 1) / (Extended(ratio) + 1);
  out.taper = k.convert_to<double>();
  const Extended fall = 1 - Extended(out.taper) * out.taper;
  out.fall_down = round_down(fall);
  out.fall_up = round_up(fall);
  out.log_fall = log(fall).convert_to<double>();
  const Extended focus = Extended(out.taper) * out.semi_axes[2];
  out.focus = focus.convert_to<double>();
  const Extended off = abs(k - out.taper);
  const Extended magnitude = abs(Extended(out.taper)) + off;
  const Extended least_fall = 1 - magnitude * magnitude;
  const Extended across =
      sqrt(Extended(out.semi_axes[0]) * out.semi_axes[0] + Extended(out.semi_axes[1]) * out.semi_axes[1]);
  const Extended moved = off * (across * (1 + magnitude / least_fall) + out.semi_axes[2] / least_fall);
  const Extended error = (moved + abs(focus - out.focus)) * (1 + Extended(0x1p-80));
  out.taper_error = error == 0 ? 0.0 : round_up(error);
  out.reach_up = round_up(Extended(out.reach_up) * (1 + magnitude));  // w = M u, M <= 1 + |k|
}

}  // namespace

std::array<Extended, 9> rotation_to_local(const std::array<double, 4>& quaternion) {
  const Extended w(quaternion[0]);
  const Extended x(quaternion[1]);
  const Extended y(quaternion[2]);
  const Extended z(quaternion[3]);
  const Extended n = w * w + x * x + y * y + z * z;
  return {
      (w * w + x * x - y * y - z * z) / n, 2 * (x * y + w * z) / n, 2 * (x * z - w * y) / n, 2 * (x * y - w * z) / n,
      (w * w - x * x + y * y - z * z) / n, 2 * (y * z + w * x) / n, 2 * (x * z + w * y) / n, 2 * (y * z - w * x) / n,
      (w * w - x * x - y * y + z * z) / n};
}

PrimitiveParameters primitive_parameters(const Primitive& primitive, int scale_exponent) {
  PrimitiveParameters out{};
  set_rotation(out, primitive.pose.quaternion);
  for (int i = 0; i < 3; ++i) {
    out.translation[i] = std::ldexp(primitive.pose.translation[i], scale_exponent);
    out.semi_axes[i] = std::ldexp(primitive.superquadric.semi_axes[i], scale_exponent);
    const Extended axis(out.semi_axes[i]);
    out.inverse_axes_up[i] = round_up(1 / axis);
    out.log_axes[i] = log(axis).convert_to<double>();
  }
  out.pose_error = pose_error(out);
  set_exponents(out, primitive.superquadric.exponents);
  set_containment(out, primitive.superquadric.exponents);
  set_radii(out, primitive.superquadric.exponents);
  set_reach(out, primitive.superquadric.exponents);
  set_taper(out, primitive.superquadric.taper);
  return out;
}

int scale_exponent(const Model& model) {
  double largest = 0.0;
  for (const Primitive& primitive : model.primitives)
    for (const double axis : primitive.superquadric.semi_axes) largest = std::max(largest, axis);
  return -std::ilogb(largest);
}

}  // namespace verisq::device
