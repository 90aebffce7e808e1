/// What a kernel is told about one primitive: the counterpart of `superquadric` in kernels/superquadric.clh.
#pragma once

#include <array>
#include <verisq/model.hpp>

#include "host/batches/directed_conversion.hpp"

namespace verisq::device {

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

/// The rotation of q/|q|, transposed (model to local frame), row by row, to far more digits than binary64 has.
[[nodiscard]] std::array<Extended, 9> rotation_to_local(const std::array<double, 4>& quaternion);

/// The scale for a model: its largest semi-axis comes to lie in [1, 2).
[[nodiscard]] int scale_exponent(const Model& model);

}  // namespace verisq::device
