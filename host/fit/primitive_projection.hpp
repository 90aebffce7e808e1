/// The signed distance of a point to one superquadric, tapered or not, bent or not, in plain binary64.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "host/fit/bent_projection.hpp"
#include "host/fit/superquadric_projection.hpp"
#include "host/fit/tapered_projection.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

/// In the solid's own frame. Proves nothing.
class PrimitiveProjection {
 public:
  /// The pose counts for nothing.
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

  /// Not more than the signed distance: that to the solid's box.
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
