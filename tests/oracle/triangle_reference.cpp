/// The program of a solid and a triangle, and what each point of its central path proves.
#include "tests/oracle/triangle_reference.hpp"

#include "tests/oracle/closest_pair.hpp"
#include "tests/oracle/solid_point.hpp"

namespace verisq::oracle {

namespace {

using Corners = std::array<Vector, 3>;

template <class Number>
[[nodiscard]] DistanceProgram<Number> program(const PosedSolid& solid, const Corners& corners) {
  DistanceProgram<Number> result;
  result.origin = converted<Number>(difference(corners[0], solid.centre()));
  result.add_superquadric(solid.superquadric().exponents, solid_axes<Number>(solid, Number(-1)));
  result.add_triangle(
      {converted<Number>(difference(corners[1], corners[0])), converted<Number>(difference(corners[2], corners[0]))});
  return result;
}

constexpr std::size_t first_weight = DistanceProgram<Real>::variables_of_superquadric;

class TriangleProof {
 public:
  TriangleProof(const PosedSolid& solid, const Corners& corners)
      : solid_(solid),
        corners_(corners),
        rounding_(rounding_at_200_bits(solid)),
        goal_(solid.largest_semi_axis() * Real(1e-27)),
        best_{Real(0), Real(0), corners[0], solid.centre(), {}} {
    for (const Vector& corner : corners) rounding_ += ldexp(length(corner), -170);
    best_.upper = length(difference(corners[0], solid.centre())) + rounding_;
  }

  [[nodiscard]] bool add(const PathPoint& point) {
    const Vector on_triangle = triangle_point(point.variables[first_weight], point.variables[first_weight + 1]);
    if (contains(solid_, on_triangle)) {
      best_ = {Real(0), Real(0), on_triangle, on_triangle, on_triangle};
      return true;
    }
    const Vector on_solid = solid_point(solid_, point.variables, 0);
    const Vector v = difference(on_triangle, on_solid);
    const Real distance = length(v);
    if (distance + rounding_ < best_.upper) {
      best_.upper = distance + rounding_;
      best_.on_triangle = on_triangle;
      best_.on_solid = on_solid;
    }
    if (distance > 0) best_.lower = std::max<Real>(best_.lower, bound(v) / distance - rounding_);
    return best_.upper - best_.lower <= goal_ + 2 * rounding_;
  }

  [[nodiscard]] const TriangleReference& best() const { return best_; }

 private:
  /// The path keeps both weights positive and their sum below 1.
  [[nodiscard]] Vector triangle_point(const Real& first, const Real& second) const {
    const Real rest = 1 - first - second;
    Vector point;
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = rest * corners_[0][k] + first * corners_[1][k] + second * corners_[2][k];
    }
    return point;
  }

  /// min_i v·t_i - h(v), not divided by |v|.
  [[nodiscard]] Real bound(const Vector& v) const {
    Real least = dot(v, difference(corners_[0], solid_.centre()));
    for (const std::size_t i : {1U, 2U}) {
      least = std::min<Real>(least, dot(v, difference(corners_[i], solid_.centre())));
    }
    return least - support(solid_, v);
  }

  const PosedSolid& solid_;
  const Corners& corners_;
  Real rounding_;
  Real goal_;
  TriangleReference best_;
};

}  // namespace

TriangleReference reference_distance(const PosedSolid& solid, const Triangle& triangle) {
  const Corners corners{widened(triangle[0]), widened(triangle[1]), widened(triangle[2])};
  TriangleProof proof(solid, corners);
  follow_path({program<double>(solid, corners), program<Real>(solid, corners)}, solid.largest_semi_axis(),
              [&](const PathPoint& point) { return proof.add(point); });
  return proof.best();
}

}  // namespace verisq::oracle
