/// The parameters of one primitive, bent or not, for kernels.
#pragma once

#include <array>
#include <verisq/model.hpp>

namespace verisq::device {

// The rotation matrix of a quaternion, for kernels that know how far it may be off.

/// The rotation by q/|q|, row by row; each entry within 2^-53 of the exact one. Precondition: finite, not zero.
[[nodiscard]] std::array<double, 9> rotation_matrix(const std::array<double, 4>& quaternion);

// A primitive's parameters for kernels: the counterpart of `superquadric` in kernels/superquadric.clh.

/// Same members, same order as in the kernels. Names ending in _down or _up bound the exact real numbers; the others
/// are the nearest and serve proposals only, except the semi-axes, which are exact.
struct PrimitiveParameters {
  double rotation[9];
  double translation[3];
  double pose_error;
  double semi_axes[3];
  double inverse_axes_up[3];
  double log_axes[3];
  double p[2];
  double p_down[2];
  double inverse_p[2];
  double inverse_p_up[2];
  double conjugate_down[2];
  double inverse_conjugate_up[2];
  double inradius_down;
  double circumradius_up;
  double reach_up;
  double containment_up;
  double taper;
  double fall_down, fall_up;
  double log_fall;
  double focus;
  double taper_error;
};

/// Parameters of a primitive in a frame whose unit is 2^-scale_exponent model units, which keeps the numbers of the
/// kernels near 1. Exact but for underflow, which the kernels' error bounds cover.
[[nodiscard]] PrimitiveParameters primitive_parameters(const Primitive& primitive, int scale_exponent);

/// The scale for a model: its largest semi-axis comes to lie in [1, 2).
[[nodiscard]] int scale_exponent(const Model& model);

// A primitive's parameters for kernels, bent or not: the counterpart of `box_primitive` in kernels/box_map.clh.

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

/// The parameters in a frame whose unit is 2^-scale_exponent model units. Precondition: within_device_range.
[[nodiscard]] BoxPrimitiveParameters box_primitive_parameters(const Primitive& primitive, int scale_exponent);

}  // namespace verisq::device
