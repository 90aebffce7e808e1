/// The signed distance of a point to a shape's surface to first order, and its derivatives: what recoveries minimise.
#pragma once

#include <Eigen/Core>

#include "host/recovery/gauge.hpp"
#include "host/recovery/shape.hpp"

namespace verisq::recovery {

/// What a step of the search changes, in this order: the centre along the shape's axes, a rotation vector in the
/// shape's frame (R becomes R exp[w]), the logarithms of the semi-axes, the exponents, the taper's k, the bend's
/// curvature along x and y.
inline constexpr int most_parameters = 14;
using Step = Eigen::Matrix<double, most_parameters, 1>;

/// Which of them vary.
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

/// f = (gauge - 1)/|gradient|, of a tapered solid f = (h - s)/|gradient| as in docs/mathematics.md §18: exact of
/// spheres, and next to faces of boxes and octahedra; elsewhere its error is of second order in the distance (Taubin,
/// PAMI 1991). The derivatives are those of the numerator, so exact on the surface.
struct SurfaceDistance {
  double value;
  Step derivatives;  ///< of a family: those that do not vary are 0
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
