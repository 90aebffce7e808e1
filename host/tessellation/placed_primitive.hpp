/// One primitive in the model's frame, to nearest: points of its surface, and what lies inside. Proves nothing.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <verisq/model.hpp>

namespace verisq::tessellation {

/// A direction in quarter turns: longitude from x to y, latitude in [-1, 1] from the x-y plane towards z.
struct SurfaceParameters {
  double longitude;
  double latitude;
};

class PlacedPrimitive {
 public:
  explicit PlacedPrimitive(const Primitive& primitive);

  /// The point of the surface which lay in this direction before semi-axes, taper, bend and pose were applied.
  [[nodiscard]] Eigen::Vector3d surface_point(const SurfaceParameters& parameters) const;

  [[nodiscard]] bool contains(const Eigen::Vector3d& point) const;

  /// Continuous, of the sign of the signed distance, and for exponents up to 1 hardly larger: in lengths of the model.
  [[nodiscard]] double level(const Eigen::Vector3d& point) const;

  /// Of a ball about `centre()` that contains the primitive.
  [[nodiscard]] double radius() const { return (semi_axes_[0] + semi_axes_[1]) * (1.0 + std::abs(k_)) + semi_axes_[2]; }
  /// Of the thinner end.
  [[nodiscard]] double smallest_semi_axis() const {
    return std::min(std::min(semi_axes_[0], semi_axes_[1]) * (1.0 - std::abs(k_)), semi_axes_[2]);
  }
  [[nodiscard]] const Eigen::Vector3d& centre() const { return translation_; }
  /// e1, of the curve along the latitude, and e2, of that along the longitude.
  [[nodiscard]] const std::array<double, 2>& exponents() const { return exponents_; }
  /// The k of the taper, (t - 1)/(t + 1); 0 for none.
  [[nodiscard]] double taper() const { return k_; }

 private:
  struct Arc {  // of the bend; curvature 0 for none
    double curvature, cosine, sine;

    [[nodiscard]] Eigen::Vector3d bent(const Eigen::Vector3d& unbent) const;
    [[nodiscard]] Eigen::Vector3d unbent(const Eigen::Vector3d& bent) const;
  };

  [[nodiscard]] Eigen::Array3d in_semi_axes(const Eigen::Vector3d& point) const;
  [[nodiscard]] double gauge(const Eigen::Array3d& unit) const;

  Eigen::Array3d semi_axes_;
  std::array<double, 2> exponents_;
  double k_;
  double steepness_ = 0.0;  // least change of the level per length, but for a factor of about 1
  Arc arc_{0.0, 1.0, 0.0};
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
};

/// The point of the curve |x|^(2/exponent) + |y|^(2/exponent) = 1 in the direction `quarter_turns` from x to y.
[[nodiscard]] Eigen::Vector2d superellipse(double quarter_turns, double exponent);

}  // namespace verisq::tessellation
