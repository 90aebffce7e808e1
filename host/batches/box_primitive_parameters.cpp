/// This file implements the enclosed constants of a primitive over cubes: frame of the bend, lower bounds, and where a
/// tapered one is widest.
#include "host/batches/box_primitive_parameters.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>

#include "host/batches/directed_conversion.hpp"

namespace verisq::device {
namespace {

// As `pose_error` of primitive_parameters: three products of factors that carry one rounding each, at most three more
// on the way, columns of length 1.
constexpr double frame_error = 5.1 * 0x1p-53;

// The rotation about z by -angle after the pose's, in more digits than binary64 can tell from exact.
void set_frame(BoxPrimitiveParameters& out, const Primitive& primitive) {
  // What is not bent keeps its own axes, whatever the angle: its normals come in them.
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

// Where ||(1, z/a3)||_p1 - k z/a3 is least over z. Its derivative vanishes where that of the norm by z/a3 is k; with q
// the conjugate exponent of p1, the one by the other component is (1 - |k|^q)^(1/q) then, and (z/a3)^p1 = |k|^q/(1 -
// |k|^q).
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
  // |r| <= |(x, y)| <= a1 + a2, times what the widest section of a tapered solid is larger by
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
