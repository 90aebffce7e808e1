/// A superquadric as a recovery varies it, and distances to its surface, to first order.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <verisq/model.hpp>

namespace verisq::recovery {

// Exponential and logarithm without branches, so that compilers make them for many numbers at once.

/// e^x to about 1e-16 of it, for -700 <= x <= 700: by Taylor's series about the nearest multiple of ln 2.
[[gnu::always_inline]] inline double fast_exponential(double x) {
  constexpr double rounder =
      0x1.8p52;  // its sum with a number below 2^51 has that number's nearest integer as its bits
  const double shifted = x * 1.4426950408889634 + rounder;
  const double multiple = shifted - rounder;
  const double r = (x - multiple * 0x1.62e42fefap-1) - multiple * 0x1.cf79abc9e3b39p-40;
  double sum = 1.0 / 6227020800.0;
  sum = sum * r + 1.0 / 479001600.0;
  sum = sum * r + 1.0 / 39916800.0;
  sum = sum * r + 1.0 / 3628800.0;
  sum = sum * r + 1.0 / 362880.0;
  sum = sum * r + 1.0 / 40320.0;
  sum = sum * r + 1.0 / 5040.0;
  sum = sum * r + 1.0 / 720.0;
  sum = sum * r + 1.0 / 120.0;
  sum = sum * r + 1.0 / 24.0;
  sum = sum * r + 1.0 / 6.0;
  sum = sum * r + 0.5;
  sum = sum * r + 1.0;
  sum = sum * r + 1.0;
  // The exponent's field: 1023 + the multiple, whose low bits are those of `shifted`.
  return sum * std::bit_cast<double>((std::bit_cast<std::uint64_t>(shifted) + 1023U) << 52U);
}

/// ln x to about 1e-16 + 1e-16 |ln x|, for normal x > 0: x = 2^k m with m from sqrt 1/2 to sqrt 2, and the series of
/// ln m = 2 artanh((m - 1)/(m + 1)).
[[gnu::always_inline]] inline double fast_logarithm(double x) {
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcdULL;  // the bits of sqrt 1/2
  constexpr std::uint64_t mantissa = 0x000fffffffffffffULL;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t above = bits - root_half + (1023ULL << 52U);
  const auto power = std::bit_cast<double>((above >> 52U) | 0x4330000000000000ULL) - (0x1p52 + 1023.0);
  const auto m = std::bit_cast<double>((above & mantissa) + root_half);
  const double s = (m - 1.0) / (m + 1.0);
  const double square = s * s;
  double sum = 1.0 / 21.0;
  sum = sum * square + 1.0 / 19.0;
  sum = sum * square + 1.0 / 17.0;
  sum = sum * square + 1.0 / 15.0;
  sum = sum * square + 1.0 / 13.0;
  sum = sum * square + 1.0 / 11.0;
  sum = sum * square + 1.0 / 9.0;
  sum = sum * square + 1.0 / 7.0;
  sum = sum * square + 1.0 / 5.0;
  sum = sum * square + 1.0 / 3.0;
  sum = sum * square + 1.0;
  return power * 0x1.62e42fefa39efp-1 + 2.0 * s * sum;
}

// A superquadric as the search of a recovery varies it: a centre, a rotation, and the members of Superquadric and Bend.

/// A point p of the cloud is R^T (p - centre) in the shape's own frame.
struct Shape {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< R, its columns are the shape's axes
  Eigen::Vector3d axes = Eigen::Vector3d::Ones();          ///< a1, a2, a3
  Eigen::Vector2d exponents = Eigen::Vector2d::Ones();     ///< e1, e2
  double taper = 0.0;                                      ///< k = (t - 1)/(t + 1) of Superquadric::taper t
  Eigen::Vector2d curvature = Eigen::Vector2d::Zero();     ///< of the bend: k (cos a, sin a), in 1/length
};

/// Below, edges are sharper than a cloud shows, and enclosures of distances are valid, not tight (docs/formats.md §2).
inline constexpr double smallest_exponent = 0.004;
inline constexpr double largest_exponent = 2.0;

/// The primitive in the form of a model file.
[[nodiscard]] Primitive primitive_of(const Shape& shape, const std::string& name);

/// The union of one or more shapes; the primitives' names state their places.
[[nodiscard]] Model model_of(std::span<const Shape> shapes);

/// The inverse of `primitive_of`, up to rounding.
[[nodiscard]] Shape shape_of(const Primitive& primitive);

// Gauge of a straight, perhaps tapered superquadric with its derivatives at one point, without branches.

/// The numbers that all points share.
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
/// (docs/mathematics.md §18), and its derivatives. `gauge_at<true>` gives derivatives of f/|gradient| instead.
struct GaugeAt {
  double value;                               ///< f
  double x, y, z;                             ///< the gradient
  double by_x = 0.0, by_y = 0.0, by_z = 0.0;  ///< by ln a1, ln a2, ln a3
  double by_along = 0.0, by_section = 0.0;    ///< by e1, e2
  double by_taper = 0.0;                      ///< by k
  double length = 0.0;                        ///< length of the gradient
};

/// N = (a^p + b^p)^(1/p) with p = 2/e. The derivative of its logarithm by ln a is `share`, by ln b `other_share`, by e
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

/// The gauge at a point of the shape's own frame. With `of_distance`, all derivatives and the gradient are those of the
/// quotient f/|gradient|, times |gradient|. |gradient| changes with a parameter as the derivative of f by that
/// parameter changes along the unit normal n. Those changes follow from the shares' logarithms.
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
  const double gauge_x = std::copysign(h * share_u / size_u, u) * shape.reciprocal_x;
  const double gauge_y = std::copysign(h * share_v / size_v, v) * shape.reciprocal_y;
  const double gauge_z = std::copysign(h * whole.other_share / size_w, w) * shape.reciprocal_z;
  GaugeAt at{.value = h - 1.0 - k * height, .x = gauge_x, .y = gauge_y, .z = gauge_z - k * shape.reciprocal_z};
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

// The signed distance of a point to a shape's surface to first order, and its derivatives: recoveries minimise it.

/// The parameters that a step of the search changes, in this order: the centre along the shape's axes, a rotation
/// vector in the shape's frame (R becomes R exp[w]), the logarithms of the semi-axes, the exponents, the taper's k, the
/// bend's curvature along x and y.
inline constexpr int most_parameters = 14;
using Step = Eigen::Matrix<double, most_parameters, 1>;

/// The parameters that vary.
enum class Family : std::uint8_t { plain, tapered, bent, bent_tapered };
[[nodiscard]] constexpr bool tapers(Family family) {
  return family == Family::tapered || family == Family::bent_tapered;
}
[[nodiscard]] constexpr bool bends(Family family) {
  return family == Family::bent || family == Family::bent_tapered;
}

[[nodiscard]] constexpr Family family_of(bool with_taper, bool with_bend) {
  if (with_bend) return with_taper ? Family::bent_tapered : Family::bent;
  return with_taper ? Family::tapered : Family::plain;
}

/// f = (gauge - 1)/|gradient|, for a tapered solid f = (h - s)/|gradient| as in docs/mathematics.md §18. It is exact
/// for spheres, and next to faces of boxes and octahedra; elsewhere its error is of second order in the distance
/// (Taubin, PAMI 1991). The derivatives are those of the numerator, so exact on the surface.
struct SurfaceDistance {
  double value;
  Step derivatives;  ///< for a family: derivatives by parameters that do not vary are 0
};

/// One shape, prepared for many points. Precondition: |curvature| times the distance of a point from the z axis below
/// 1, or the value is that of a point elsewhere.
class DistanceToShape {
 public:
  DistanceToShape(const Shape& shape, Family family);

  [[nodiscard]] double value(const Eigen::Vector3d& point) const;
  void evaluate(const Eigen::Vector3d& point, SurfaceDistance& distance) const;

 private:
  Shape shape_;
  GaugeConstants gauge_;
  Family family_;
  bool bent_;
};

/// The shape after a step, its exponents and taper within their limits.
[[nodiscard]] Shape moved(const Shape& shape, const Step& step);

}  // namespace verisq::recovery
