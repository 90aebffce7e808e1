/// Solids in plain binary64: primitives in their place, their surfaces as grids, levels of set operations.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::tessellation {

// One primitive in the model's frame, to nearest: points of its surface, and its interior. Proves nothing.

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

  /// Radius of a ball about `centre()` that contains the primitive.
  [[nodiscard]] double radius() const { return (semi_axes_[0] + semi_axes_[1]) * (1.0 + std::abs(k_)) + semi_axes_[2]; }
  /// The smallest semi-axis at the thinner end.
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

// One primitive's surface as a grid of longitudes and latitudes, as fine as the surface is curved.

/// Closed, manifold, outward by the right-hand rule. Vertices lie on the surface, some of them on its edges and
/// corners; between them the mesh is at most about `deviation` away.
[[nodiscard]] Mesh parametric_surface(const PlacedPrimitive& primitive, double deviation);

// A model's solid to nearest: the points that it contains, the primitive that contains them, and its surface along a
// line.

class Solid {
 public:
  /// The model must outlive it.
  explicit Solid(const Model& model);

  [[nodiscard]] const std::vector<PlacedPrimitive>& primitives() const { return primitives_; }

  [[nodiscard]] bool contains(const Eigen::Vector3d& point) const;

  /// The same for a point for which it is known whether primitive k contains it.
  [[nodiscard]] bool contains(const Eigen::Vector3d& point, std::size_t k, bool in_k) const;

  /// `PlacedPrimitive::level` through the set operations, at most 0 in the solid, and the primitive that decides it.
  struct Level {
    double value;
    std::size_t primitive;
  };
  [[nodiscard]] Level level(const Eigen::Vector3d& point) const;

  /// The direction in which the level grows, of unit length, from differences over `step`; zero where there is none.
  [[nodiscard]] Eigen::Vector3d outward(const Eigen::Vector3d& point, double step) const;

  /// The place at which the line from `inside` to `outside` leaves the solid, as a fraction of the way. Precondition:
  /// the solid contains `inside` and does not contain `outside`.
  [[nodiscard]] double crossing(const Eigen::Vector3d& inside, const Eigen::Vector3d& outside) const;

  /// The point of the surface nearest to `point` on the line through it, at most `reach` away; `outward`, of unit
  /// length, leads out of the solid there. Nothing if both ends are inside or outside.
  [[nodiscard]] std::optional<Eigen::Vector3d> surface_along(const Eigen::Vector3d& point,
                                                             const Eigen::Vector3d& outward, double reach) const;

 private:
  const Model& model_;
  std::vector<PlacedPrimitive> primitives_;
};

}  // namespace verisq::tessellation
