/// What a kernel is told about one primitive, bent or not: the counterpart of `box_primitive` in kernels/box_map.clh.
#pragma once

#include "host/batches/primitive_parameters.hpp"

namespace verisq::device {

/// Same members, same order as in the kernels. Names ending in _down or _up bound the exact real numbers, the curvature
/// is exact, the others are the nearest. A negative curvature is a positive one the other way round.
struct BoxPrimitiveParameters {
  PrimitiveParameters solid;
  double frame[9];
  double frame_error;
  double curvature;
  double least_w;
  double bend_cos;
  double bend_sin;
  double inverse_axes_down[3];
  double p_up[2];
  double inverse_p_down[2];
  double turn;
  double turn_share;
};

/// In a frame whose unit is 2^-scale_exponent model units. Precondition: within_device_range.
[[nodiscard]] BoxPrimitiveParameters box_primitive_parameters(const Primitive& primitive, int scale_exponent);

}  // namespace verisq::device
