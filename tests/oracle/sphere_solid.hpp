/// The exact signed distance of models made of spheres, whatever their tree: a closed form at 200 bits.
#pragma once

#include <optional>
#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/membership.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

/// The nearest point of the solid, or of its complement, lies inside a face, an edge or at a corner of the boundary,
/// and is stationary there: a pole of a sphere as seen from the query, an end of the diameter of the circle where two
/// meet that points to the query, or a point where three meet. The nearest of those that belong to the closed set
/// decides. Precondition: all primitives are spheres without bends, each at most once in the tree.
class SphereSolid {
 public:
  explicit SphereSolid(const Model& model);

  /// Nothing where stationary points are not isolated: at a centre, on the axis of a circle.
  [[nodiscard]] std::optional<ReferenceDistance> signed_distance(const Point& point) const;

 private:
  struct Sphere {
    Vector centre;
    Real radius;
  };
  struct Circle {
    Vector centre;
    Vector normal;  ///< unit
    Real radius;
  };
  [[nodiscard]] std::optional<Circle> circle(const Sphere& a, const Sphere& b) const;
  [[nodiscard]] Membership membership(const Vector& point) const;
  [[nodiscard]] bool add_poles(const Vector& q, std::vector<Vector>& candidates) const;
  [[nodiscard]] bool add_rims(const Vector& q, std::vector<Vector>& candidates) const;

  Model model_;
  std::vector<Sphere> spheres_;
  Real margin_;  ///< a length far above the rounding
};

}  // namespace verisq::oracle
