/// This file implements primitive_parameters.hpp.
#include "host/device/primitive_parameters.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cfloat>
#include <cmath>
#include <cstddef>

#include "verisq/enclosure.hpp"

namespace verisq::device {

// With v = 2^-64: squares and products of components carry one rounding, sums of four of them three more. So numerators
// are off by at most 4.1 v n, n = |q|^2, the divisor by 4.1 v n, and the quotient, at most 1, by 9.3 v. The rounding to
// binary64 adds 2^-54: together less than 2^-53. Scaled to largest component 1, nothing overflows, and underflow is
// negligible.
std::array<double, 9> rotation_matrix(const std::array<double, 4>& quaternion) {
  static_assert(LDBL_MANT_DIG >= 64, "the error bound needs 64 bits");
  double largest = 0.0;
  for (const double c : quaternion) largest = std::max(largest, std::abs(c));
  const int scale = -std::ilogb(largest);
  const auto component = [&](std::size_t i) { return std::scalbn(static_cast<long double>(quaternion[i]), scale); };
  const long double w = component(0);
  const long double x = component(1);
  const long double y = component(2);
  const long double z = component(3);
  const long double ww = w * w;
  const long double xx = x * x;
  const long double yy = y * y;
  const long double zz = z * z;
  const long double n = ww + xx + yy + zz;
  const auto entry = [n](long double numerator) { return static_cast<double>(numerator / n); };
  return {entry(ww + xx - yy - zz),   entry(2 * (x * y - w * z)), entry(2 * (x * z + w * y)),
          entry(2 * (x * y + w * z)), entry(ww - xx + yy - zz),   entry(2 * (y * z - w * x)),
          entry(2 * (x * z - w * y)), entry(2 * (y * z + w * x)), entry(ww - xx - yy + zz)};
}

namespace {

// Numbers of many digits on their way to binary64: the constants of kernels are computed with them.

using Extended =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60>, boost::multiprecision::et_off>;

double round_down(const Extended& x) {
  const auto nearest = x.convert_to<double>();
  return Extended(nearest) <= x ? nearest : std::nextafter(nearest, -infinity);
}

double round_up(const Extended& x) {
  return -round_down(-x);
}

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

// Norms of two numbers fall with the exponent: ||w||_p <= ||w||_p_down <= 2^(1/p_down - 1/p) ||w||_p. So the gauge with
// p_down is at most 2^d times the exact one, d = sum of 1/p_down - 1/p over both exponents, with 1/p = e/2. And 2^d <=
// 1 + d for d in [0, 1].
void set_containment(PrimitiveParameters& out, const std::array<double, 2>& exponents) {
  Extended d = 0;
  for (int i = 0; i < 2; ++i) {
    const Extended difference = (2 - Extended(exponents[i]) * out.p_down[i]) / (2 * Extended(out.p_down[i]));
    if (difference > 0) d += difference;
  }
  out.containment_up = d == 0 ? 1.0 : round_up(1 + d * (1 + Extended(0x1p-100)));  // quotients are rounded
}

// Bound of |computed - exact local point| / |x - translation|_1. Each component of the local point is a sum of three
// products R_ij d_j whose factors carry one rounding each and which pass through at most three more. Columns of R have
// length 1, so the error vector is at most ((1 + u)^5 - 1) |d|_1 < 5.01 u |d|_1. An entry below 2^-1022 is off by
// 2^-1075, for which the rest of 5.1 u has room. In many digits an entry is 0 only if it is exactly 0: sums of two
// exact products do not round to zero, and their exponents have no relevant limit. Its binary64 number may still
// vanish.
double pose_error(const PrimitiveParameters& out, const std::array<Extended, 9>& rotation) {
  const bool permutes =
      std::ranges::all_of(rotation, [](const Extended& entry) { return entry == 0 || abs(entry) == 1; });
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

// The greatest |(x, y)| with ||(x/a, y/b)||_p <= 1, p = 2/e. By Hoelder's inequality for squares, whose exponent is
// p/2, it is the norm of (a, b) with exponent 2 p/(p - 2) = 2/(1 - e); for p <= 2 the greater of both.
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

// With k' the rounded k, consider a point of the solid, ((1 + k z) x, (1 + k z) y, a3 z) with z = (Z - k)/(1 - k Z).
// Per unit of k, it moves with k along z by a3 (1 - Z^2)/(1 - k Z)^2 <= a3/(1 - k^2), and across by |(a1, a2)| |z + k
// dz/dk| <= |(a1, a2)| (1 + |k|/(1 - k^2)). Between k and k' it moves by at most |k - k'| times their sum for the
// greater of both. If each point of a convex set has a point of the other within that, their distances, and those about
// a rounded focus, differ by no more.
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

/// The rotation of q/|q|, transposed (model to local frame), row by row, to far more digits than binary64 has.
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

}  // namespace

PrimitiveParameters primitive_parameters(const Primitive& primitive, int scale_exponent) {
  PrimitiveParameters out{};
  const std::array<Extended, 9> rotation = rotation_to_local(primitive.pose.quaternion);
  std::ranges::transform(rotation, std::begin(out.rotation),
                         [](const Extended& entry) { return entry.convert_to<double>(); });  // rounded once
  for (int i = 0; i < 3; ++i) {
    out.translation[i] = std::ldexp(primitive.pose.translation[i], scale_exponent);
    out.semi_axes[i] = std::ldexp(primitive.superquadric.semi_axes[i], scale_exponent);
    const Extended axis(out.semi_axes[i]);
    out.inverse_axes_up[i] = round_up(1 / axis);
    out.log_axes[i] = log(axis).convert_to<double>();
  }
  out.pose_error = pose_error(out, rotation);
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

namespace {

// Like `pose_error` of primitive_parameters: three products of factors that carry one rounding each, at most three more
// on the way, columns of length 1.
constexpr double frame_error = 5.1 * 0x1p-53;

// The rotation about z by -angle after the pose's, with errors far below binary64's.
void set_frame(BoxPrimitiveParameters& out, const Primitive& primitive) {
  // An unbent primitive keeps its own axes, whatever the angle: its normals are in them.
  const bool bent = is_bent(primitive);
  const double degrees = bent ? std::fmod(primitive.bend->angle_degrees, 360.0) : 0.0;  // exact
  const Extended angle = Extended(degrees) / 180 * boost::math::constants::pi<Extended>();
  const int way = bent && primitive.bend->curvature < 0.0 ? -1 : 1;
  const Extended cosine = way * cos(angle);
  const Extended sine = way * sin(angle);
  const std::array<Extended, 9> pose = rotation_to_local(primitive.pose.quaternion);
  for (std::size_t i = 0; i < 3; ++i) {
    out.frame[i] = Extended(cosine * pose[i] + sine * pose[3 + i]).convert_to<double>();
    out.frame[3 + i] = Extended(cosine * pose[3 + i] - sine * pose[i]).convert_to<double>();
    out.frame[6 + i] = pose[6 + i].convert_to<double>();
  }
  out.frame_error = frame_error;
  out.bend_cos = cosine.convert_to<double>();
  out.bend_sin = sine.convert_to<double>();
}

// The z at which ||(1, z/a3)||_p1 - k z/a3 is least. Its derivative vanishes where the derivative of the norm by z/a3
// is k. With q the conjugate exponent of p1, the derivative by the other component is then (1 - |k|^q)^(1/q), and
// (z/a3)^p1 = |k|^q/(1 - |k|^q).
void set_turn(BoxPrimitiveParameters& out, const Superquadric& solid) {
  const Extended e(solid.exponents[0]);
  out.turn = 0.0;
  out.turn_share = 1.0;
  if (e == 2) return;  // q is infinite
  const Extended power = pow(Extended(std::abs(out.solid.taper)), 2 / (2 - e));
  const Extended height = out.solid.semi_axes[2] * pow(power / (1 - power), e / 2);
  out.turn = std::copysign(height.convert_to<double>(), out.solid.taper);
  out.turn_share = pow(1 - power, (2 - e) / 2).convert_to<double>();
}

}  // namespace

BoxPrimitiveParameters box_primitive_parameters(const Primitive& primitive, int scale_exponent) {
  BoxPrimitiveParameters out{};
  out.solid = primitive_parameters(primitive, scale_exponent);
  set_frame(out, primitive);
  out.curvature = primitive.bend ? std::ldexp(std::abs(primitive.bend->curvature), -scale_exponent) : 0.0;
  // |r| <= |(x, y)| <= a1 + a2, times the widening of a tapered solid's widest section
  const Extended widest = (1 + abs(Extended(out.solid.taper))) * (1 + Extended(0x1p-50));
  const Extended across = widest * (Extended(out.solid.semi_axes[0]) + out.solid.semi_axes[1]);
  out.least_w = round_down(1 - Extended(out.curvature) * across);
  for (std::size_t i = 0; i < 3; ++i) out.inverse_axes_down[i] = round_down(1 / Extended(out.solid.semi_axes[i]));
  for (std::size_t i = 0; i < 2; ++i) {
    out.p_up[i] = round_up(2 / Extended(primitive.superquadric.exponents[i]));
    out.inverse_p_down[i] = round_down(Extended(primitive.superquadric.exponents[i]) / 2);
  }
  set_turn(out, primitive.superquadric);
  return out;
}

}  // namespace verisq::device
