/// A superquadric as the search of a recovery varies it: a centre, a rotation, and what Superquadric and Bend hold.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <verisq/model.hpp>

namespace verisq::recovery {

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

/// As a model file has it.
[[nodiscard]] Primitive primitive_of(const Shape& shape, const std::string& name);

/// The union of one or more, whose names say their places.
[[nodiscard]] Model model_of(std::span<const Shape> shapes);

/// The inverse of `primitive_of`, up to rounding.
[[nodiscard]] Shape shape_of(const Primitive& primitive);

}  // namespace verisq::recovery
