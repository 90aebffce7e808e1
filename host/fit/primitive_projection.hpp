/// The signed distance of a point to one superquadric, tapered or not, in plain binary64.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "host/fit/superquadric_projection.hpp"
#include "host/fit/tapered_projection.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

/// In the solid's own frame. Proves nothing.
class PrimitiveProjection {
 public:
  explicit PrimitiveProjection(const Superquadric& solid) : projection_(projection_of(solid)) {}

  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const {
    return std::visit([&](const auto& projection) { return projection(q); }, projection_);
  }

  /// Not more than the signed distance: that to the solid's box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const {
    return std::visit([&](const auto& projection) { return projection.lower_bound(q); }, projection_);
  }

 private:
  using Either = std::variant<SuperquadricProjection, TaperedProjection>;

  static Either projection_of(const Superquadric& solid) {
    if (is_tapered(solid)) return TaperedProjection(solid);
    return SuperquadricProjection(solid);
  }

  Either projection_;
};

}  // namespace verisq::fit_search
