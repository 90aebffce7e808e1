/// The closest points of an implant's primitives, tapered or not, bent or not, in floating point.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "verify/proposals/support_mapping.hpp"
#include "verify/search/pair_projection.hpp"
#include "verisq/model.hpp"

namespace verisq::fit_search {

// The signed distance of a point to one superquadric in plain binary64, as searches for poses need it.

/// In the solid's own frame. The distance changes with the point along `normal`, a unit vector, and with semi-axis i by
/// -normal[i] * nearest[i] / a[i]: sd(q) = max over |v| = 1 of v·q - h(v), and h depends on the products a[i] v[i]
/// only.
struct Projection {
  double distance;  ///< negative inside
  Eigen::Vector3d normal;
  Eigen::Vector3d nearest;  ///< the closest point of the surface
};

/// Derivatives of a distance by the semi-axes, as above.
[[nodiscard]] inline Eigen::Vector3d size_gradient(const Eigen::Vector3d& normal, const Eigen::Vector3d& nearest,
                                                   const Superquadric& solid) {
  const auto& [a, b, c] = solid.semi_axes;
  return -normal.cwiseProduct(nearest).cwiseQuotient(Eigen::Vector3d(a, b, c));
}

/// Outside by Newton's method on the optimality conditions. Inside by walks along the surface normal at the point where
/// the last walk ended; this never lengthens the way and stops at a locally shortest one. If Newton's method does not
/// converge, the host's proof takes its place. Proves nothing.
class SuperquadricProjection {
 public:
  explicit SuperquadricProjection(const Superquadric& solid);

  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const;

  /// A lower bound of the signed distance: the distance to the solid's box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const;

 private:
  [[nodiscard]] Projection proven(const Eigen::Vector3d& q) const;
  [[nodiscard]] Projection from_inside(const Eigen::Vector3d& q) const;

  Superquadric solid_;
  verify::PairProjection outside_;
  verify::Boundary<double> boundary_;
};

// Sums of numbers that are known by their logarithms, in plain binary64.

/// log(e^a + e^b) and the share of e^b in the sum.
struct LogSum {
  double value, share;
};

[[nodiscard]] inline LogSum log_sum(double a, double b) {
  const double smaller = std::exp(-std::fabs(a - b));
  const double larger_share = 1.0 / (1.0 + smaller);
  return {std::max(a, b) + std::log1p(smaller), b > a ? larger_share : smaller * larger_share};
}

/// Squares of e^+-300 are normal numbers.
[[nodiscard]] inline double bounded_exp(double x) {
  return std::exp(std::clamp(x, -300.0, 300.0));
}

// The point of a tapered superquadric closest to a point outside: Newton's method in logarithms.

/// Solves, in binary64, the optimality conditions of docs/mathematics.md §18, which kernels/tapered_enclosure.clh
/// solves in binary32. About the focus the closest point is M u with u on the untapered surface.
class TaperedNewton {
 public:
  /// Precondition: exponents below 2.
  explicit TaperedNewton(const Superquadric& solid);

  /// u for q = (q_x >= 0, q_y >= 0, q_z) about the focus; nothing where Newton's method does not converge. Proves
  /// nothing. Precondition: q is outside.
  [[nodiscard]] std::optional<Eigen::Vector3d> operator()(const Eigen::Vector3d& q) const;

 private:
  struct Query;
  struct Unknowns;
  struct Equations;

  [[nodiscard]] double beyond_section(double q, double share_beyond, int axis) const;
  [[nodiscard]] double pushed_height(const Eigen::Vector3d& q) const;
  [[nodiscard]] std::optional<double> height_on_wall(const Query& q) const;
  [[nodiscard]] Unknowns start(const Query& q) const;
  [[nodiscard]] Unknowns start_untapered(const Eigen::Array3d& q, const Eigen::Array3d& log_q) const;
  [[nodiscard]] Equations equations_at(const Unknowns& u, const Query& q) const;
  [[nodiscard]] Unknowns step(const Equations& e) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> on_side(const Eigen::Vector3d& q, double pushed, double side) const;

  Eigen::Array3d axes_, log_axes_;
  double p1_, p2_;
  double k_, fall_;  ///< k, 1 - k²
};

// The signed distance of a point to one tapered superquadric in plain binary64, as searches for poses need it.

/// Like SuperquadricProjection, for a tapered solid (docs/mathematics.md §18): by tangent planes that come ever nearer
/// to the point, as in kernels/tapered_distance_gradient.clh. If they do not lead to the closest point of a point
/// outside, the host's search for contacts takes their place. Inside they stop at a locally shortest way. Proves
/// nothing.
class TaperedProjection {
 public:
  explicit TaperedProjection(const Superquadric& solid);

  /// The derivatives by the sizes are those of an untapered solid: the taper scales as the semi-axes do.
  [[nodiscard]] Projection operator()(const Eigen::Vector3d& q) const;

  /// A lower bound of the signed distance: the distance to a box.
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& q) const;

 private:
  struct Plane;
  struct BoundaryPlane;

  [[nodiscard]] Plane plane(const Eigen::Vector3d& v, const Eigen::Vector3d& q) const;
  [[nodiscard]] Plane nearest_end_or_wall(const Eigen::Vector3d& q) const;
  [[nodiscard]] BoundaryPlane plane_through(const Eigen::Vector3d& x, const Eigen::Vector3d& q) const;
  [[nodiscard]] Eigen::Vector3d newton_step(const BoundaryPlane& at, const Eigen::Vector3d& q) const;
  [[nodiscard]] BoundaryPlane nearest_plane(const Plane& first, const Eigen::Vector3d& q) const;
  [[nodiscard]] bool closest(const BoundaryPlane& at, const Eigen::Vector3d& q) const;
  [[nodiscard]] static Projection projection(const Plane& plane, const Eigen::Vector3d& p);
  [[nodiscard]] Projection by_contact(const Eigen::Vector3d& q) const;

  Superquadric solid_;
  Eigen::Array3d axes_;
  double p1_, p2_;
  double k_, fall_;  ///< k, 1 - k²
  TaperedNewton newton_;
};

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
