/// Gauge of a straight, perhaps tapered superquadric with its derivatives at one point, without branches.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "host/recovery/elementary_functions.hpp"
#include "host/recovery/shape.hpp"

namespace verisq::recovery {

/// What all points share.
struct GaugeConstants {
  explicit GaugeConstants(const Shape& shape)
      : reciprocal_x(1.0 / shape.axes[0]),
        reciprocal_y(1.0 / shape.axes[1]),
        reciprocal_z(1.0 / shape.axes[2]),
        height(shape.axes[2]),
        along_power(2.0 / shape.exponents[0]),
        section_power(2.0 / shape.exponents[1]),
        taper(shape.taper) {}

  double reciprocal_x;
  double reciprocal_y;
  double reciprocal_z;
  double height;         ///< a3
  double along_power;    ///< 2/e1
  double section_power;  ///< 2/e2
  double taper;          ///< k
};

/// f = h(x, y, z + k a3) - (1 + k z/a3), h the gauge: 0 on the surface of the tapered solid, convex
/// (docs/mathematics.md §18), and its derivatives. `derivatives_of_distance` makes of them those of f/|gradient|.
struct GaugeAt {
  double value;                 ///< f
  double x, y, z;               ///< the gradient
  double by_x, by_y, by_z;      ///< by ln a1, ln a2, ln a3
  double by_along, by_section;  ///< by e1, e2
  double by_taper;              ///< by k
  double length;                ///< of the gradient
};

/// N = (a^p + b^p)^(1/p) with p = 2/e. Of its logarithm: the derivative by ln a is `share`, by ln b `other_share`, by e
/// half the entropy of the two.
struct PlanarNorm {
  double value;
  double share;
  double other_share;
  double entropy;
  double odds;  ///< ln(share/other_share)
};

[[gnu::always_inline]] inline PlanarNorm planar_norm(double a, double b, double power) {
  constexpr double least_exponent = -650.0;  // what is as small counts for nothing
  const double larger = a > b ? a : b;
  const double smaller = a > b ? b : a;
  const double exponent = std::max(power * fast_logarithm(smaller / larger), least_exponent);
  const double ratio = fast_exponential(exponent);
  const double of_larger = 1.0 / (1.0 + ratio);
  const double of_smaller = ratio * of_larger;
  const double logarithm = fast_logarithm(1.0 + ratio);
  return {larger * fast_exponential(logarithm / power), a > b ? of_larger : of_smaller, a > b ? of_smaller : of_larger,
          logarithm - of_smaller * exponent, a > b ? -exponent : exponent};
}

/// At a point of the shape's own frame. With `of_distance`, all derivatives and the gradient are those of the quotient
/// f/|gradient|, times |gradient|: |gradient| changes with a parameter as the derivative of f by that parameter changes
/// along the unit normal n, and those changes follow from the shares' logarithms.
template <bool of_distance>
[[gnu::always_inline]] inline GaugeAt gauge_at(const GaugeConstants& shape, double x, double y, double z) {
  constexpr double tiny = 1e-30;          // stands for 0 where a logarithm is taken
  constexpr double nearest_plane = 1e-3;  // of a semi-axis: nearer to it second derivatives may be infinite
  const double k = shape.taper;
  const double height = z * shape.reciprocal_z;
  const double u = x * shape.reciprocal_x;
  const double v = y * shape.reciprocal_y;
  const double w = height + k;
  const double size_u = std::max(std::abs(u), tiny);
  const double size_v = std::max(std::abs(v), tiny);
  const double size_w = std::max(std::abs(w), tiny);
  const PlanarNorm section = planar_norm(size_u, size_v, shape.section_power);
  const PlanarNorm whole = planar_norm(section.value, size_w, shape.along_power);
  const double h = whole.value;
  const double share_u = whole.share * section.share;
  const double share_v = whole.share * section.other_share;
  const double share_w = whole.other_share;
  const double gauge_x = std::copysign(h * share_u / size_u, u) * shape.reciprocal_x;
  const double gauge_y = std::copysign(h * share_v / size_v, v) * shape.reciprocal_y;
  const double gauge_z = std::copysign(h * share_w / size_w, w) * shape.reciprocal_z;
  GaugeAt at{};
  at.value = h - 1.0 - k * height;
  at.x = gauge_x;
  at.y = gauge_y;
  at.z = gauge_z - k * shape.reciprocal_z;
  at.length = std::max(std::sqrt(at.x * at.x + at.y * at.y + at.z * at.z), tiny);
  at.by_x = -gauge_x * x;
  at.by_y = -gauge_y * y;
  at.by_z = k * height - gauge_z * z;
  at.by_along = 0.5 * h * whole.entropy;
  at.by_section = 0.5 * h * whole.share * section.entropy;
  at.by_taper = gauge_z * shape.height - height;
  if constexpr (of_distance) {
    const double normal_x = at.x / at.length;
    const double normal_y = at.y / at.length;
    const double normal_z = at.z / at.length;
    const double distance = at.value / at.length;
    // Rates along n of ln |u|, ln |v|, ln |w|, of the norms and of the shares.
    const double rate_u = normal_x * shape.reciprocal_x * std::copysign(1.0 / std::max(size_u, nearest_plane), u);
    const double rate_v = normal_y * shape.reciprocal_y * std::copysign(1.0 / std::max(size_v, nearest_plane), v);
    const double rate_w = normal_z * shape.reciprocal_z * std::copysign(1.0 / std::max(size_w, nearest_plane), w);
    const double section_rate = section.share * rate_u + section.other_share * rate_v;
    const double gauge_rate = whole.share * section_rate + whole.other_share * rate_w;
    const double within = shape.section_power * (rate_u - rate_v);
    const double between = shape.along_power * (section_rate - rate_w);
    const double upper_rate = whole.other_share * between;  // of ln of the section's share
    // The gauge's second derivative times n.
    const double curved_x = gauge_x * (gauge_rate + upper_rate + section.other_share * within - rate_u);
    const double curved_y = gauge_y * (gauge_rate + upper_rate - section.share * within - rate_v);
    const double curved_z = gauge_z * (gauge_rate - whole.share * between - rate_w);
    at.x -= distance * curved_x;
    at.y -= distance * curved_y;
    at.z -= distance * curved_z;
    at.by_x += distance * (curved_x * x + gauge_x * normal_x);
    at.by_y += distance * (curved_y * y + gauge_y * normal_y);
    at.by_z += distance * (curved_z * z + gauge_z * normal_z - k * normal_z * shape.reciprocal_z);
    at.by_along -=
        distance * 0.5 * h * (gauge_rate * whole.entropy - whole.odds * whole.share * whole.other_share * between);
    at.by_section -=
        distance * 0.5 * h * whole.share *
        ((gauge_rate + upper_rate) * section.entropy - section.odds * section.share * section.other_share * within);
    at.by_taper -= distance * (curved_z * shape.height - normal_z * shape.reciprocal_z);
  }
  return at;
}

}  // namespace verisq::recovery
