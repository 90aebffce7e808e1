/// The closest points of an implant's primitives, bent or not, in floating point.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "host/plan/convex_projection.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

// The signed distance of a point to one bent superquadric in plain binary64, as searches for poses need it.

/// Like SuperquadricProjection, for a bent solid β(K), tapered or not (docs/mathematics.md §9). It minimises |β(x) -
/// q|² over the surface of the unbent K, by steps each of which projects onto K stretched along its axis, a
/// superquadric as well. If bends are strong and points are far, it may stop at a locally shortest way. Proves nothing.
class BentProjection {
 public:
  /// Precondition: the bend is one of this solid's (Bend).
  BentProjection(const Superquadric& solid, const Bend& bend);

  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const;

  /// The image, under the bend, of a point of the solid's own frame.
  [[nodiscard]] Eigen::Vector3d image(const Eigen::Vector3d& unbent) const;

  /// Derivatives of a found distance by the semi-axes of K.
  [[nodiscard]] Eigen::Vector3d size_gradient(const Projection& found) const;

  /// A lower bound of the signed distance: the distance to a box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const;

 private:
  /// A point of the surface of K and the unit normal there, in the frame of the bend.
  struct Foot {
    Eigen::Vector3d point, normal;
    bool inside;  ///< whether the point to which it is nearest lies in K
  };

  [[nodiscard]] Eigen::Vector3d bent(const Eigen::Vector3d& x) const;
  [[nodiscard]] Eigen::Vector3d unbent(const Eigen::Vector3d& x) const;
  [[nodiscard]] Foot foot(const Eigen::Vector3d& t, double metric) const;
  [[nodiscard]] Foot step(const Foot& from, const Eigen::Vector3d& q) const;
  [[nodiscard]] Projection projection(const Foot& foot, const Eigen::Vector3d& q, bool inside) const;

  Superquadric solid_;
  double curvature_;
  Eigen::Matrix3d turn_;                  ///< to the frame of the bend
  Eigen::Array3d box_lower_, box_upper_;  ///< contain the bent solid, in the frame of the bend
};

// The signed distance of a point to one superquadric, tapered or not, bent or not, in plain binary64.

/// All vectors are in the solid's own frame. Proves nothing.
class PrimitiveProjection {
 public:
  /// The pose is ignored.
  explicit PrimitiveProjection(const Primitive& primitive)
      : solid_(primitive.superquadric), projection_(projection_of(primitive)) {}

  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const {
    return std::visit([&](const auto& projection) { return projection(q); }, projection_);
  }

  /// Derivatives of a distance found by the semi-axes.
  [[nodiscard]] Eigen::Vector3d size_gradient(const Projection& found) const {
    if (const auto* const bent = std::get_if<BentProjection>(&projection_)) return bent->size_gradient(found);
    return fit_search::size_gradient(found.normal, found.nearest, solid_);
  }

  /// A lower bound of the signed distance: the distance to the solid's box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const {
    return std::visit([&](const auto& projection) { return projection.lower_bound(q); }, projection_);
  }

 private:
  using Any = std::variant<SuperquadricProjection, TaperedProjection, BentProjection>;

  static Any projection_of(const Primitive& primitive) {
    if (is_bent(primitive)) return BentProjection(primitive.superquadric, *primitive.bend);
    if (is_tapered(primitive.superquadric)) return TaperedProjection(primitive.superquadric);
    return SuperquadricProjection(primitive.superquadric);
  }

  Superquadric solid_;
  Any projection_;
};

}  // namespace verisq::fit_search
