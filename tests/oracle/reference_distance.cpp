/// Pose, choice of side, and the rounding at 200 bits, added at the end.
#include "tests/oracle/reference_distance.hpp"

#include "tests/oracle/projection.hpp"

namespace verisq::oracle {

namespace {

/// Rows of the rotation of quaternion/|quaternion|, in the form that keeps exact zeros exact.
[[nodiscard]] Triple<Vector> rotation_of(const std::array<double, 4>& quaternion) {
  const Real w = quaternion[0];
  const Real x = quaternion[1];
  const Real y = quaternion[2];
  const Real z = quaternion[3];
  const Real squared = w * w + x * x + y * y + z * z;
  const Triple<Vector> rows{Vector{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                            Vector{2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                            Vector{2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
  return {scaled<Real>(rows[0], 1 / squared), scaled<Real>(rows[1], 1 / squared), scaled<Real>(rows[2], 1 / squared)};
}

}  // namespace

PosedSolid::PosedSolid(const Superquadric& superquadric, const Pose& pose)
    : superquadric_(superquadric),
      norm_(superquadric),
      translation_(widened(pose.translation)),
      rotation_(rotation_of(pose.quaternion)),
      largest_semi_axis_(*std::max_element(norm_.semi_axes().begin(), norm_.semi_axes().end())) {}

Vector PosedSolid::to_own_frame(const Vector& point) const {
  return turned_to_own_frame(difference(point, translation_));
}

Vector PosedSolid::turned_to_own_frame(const Vector& v) const {
  Vector local;
  for (std::size_t i = 0; i < 3; ++i)
    local[i] = rotation_[0][i] * v[0] + rotation_[1][i] * v[1] + rotation_[2][i] * v[2];
  return local;
}

PosedSolid PosedSolid::moved(const Pose& motion) const {
  const Triple<Vector> turn = rotation_of(motion.quaternion);
  PosedSolid result = *this;
  for (std::size_t i = 0; i < 3; ++i) {
    result.translation_[i] = dot(turn[i], translation_) + motion.translation[i];
    for (std::size_t j = 0; j < 3; ++j) {
      result.rotation_[i][j] =
          turn[i][0] * rotation_[0][j] + turn[i][1] * rotation_[1][j] + turn[i][2] * rotation_[2][j];
    }
  }
  return result;
}

Vector PosedSolid::from_own_frame(const Vector& local) const {
  Vector point;
  for (std::size_t i = 0; i < 3; ++i) point[i] = dot(rotation_[i], local) + translation_[i];
  return point;
}

Real PosedSolid::magnitude(const Point& point) const {
  return std::max<Real>(length(to_own_frame(widened(point))), largest_semi_axis_);
}

/// Every operation is correctly rounded to 201 bits, and each result is a handful of norms and dot products whose
/// relative errors do not add up to 2^-190 of the magnitudes involved; 2^-170 of them is beyond doubt.
Real PosedSolid::rounding_at(const Vector& point) const {
  return ldexp(length(point) + length(translation_) + largest_semi_axis_, -170);
}

ReferenceDistance PosedSolid::signed_distance(const Point& point, Search search) const {
  const Vector global = widened(point);
  Vector q = to_own_frame(global);
  for (Real& coordinate : q) coordinate = abs(coordinate);
  const Real rounding = rounding_at(global);

  const Real excess = norm_.gauge(q) - 1;
  if (abs(excess) < ldexp(Real(1), -160)) {
    // On the boundary: q and q/g(q) are this close to each other.
    const Real slack = ldexp(length(q), -159) + rounding;
    return {-slack, slack, true};
  }
  if (excess > 0) {
    const Bounds bounds = project_from_outside(superquadric_, norm_, q).distance;
    return {bounds.lower - rounding, bounds.upper + rounding, true};
  }
  const Real best = deepest_direction(superquadric_, norm_, q, search).bound;
  return {best - rounding, best + rounding, false};
}

ReferencePoint PosedSolid::closest_point(const Point& point, Search search) const {
  const Vector global = widened(point);
  const Vector own = to_own_frame(global);
  const Vector q{abs(own[0]), abs(own[1]), abs(own[2])};
  const Real rounding = rounding_at(global);
  const auto in_model = [&](Vector p) {
    for (std::size_t i = 0; i < 3; ++i) p[i] = own[i] < 0 ? Real(-p[i]) : p[i];
    return from_own_frame(p);
  };
  if (norm_.gauge(q) > 1) {
    const auto [bounds, p] = project_from_outside(superquadric_, norm_, q);
    const Real lower = std::max<Real>(Real(0), bounds.lower - rounding);
    const Real upper = bounds.upper + rounding;
    return {{lower, upper, true}, in_model(p), sqrt(upper * upper - lower * lower) + rounding};
  }
  const DeepestDirection best = deepest_direction(superquadric_, norm_, q, search);
  const Vector foot = difference(q, scaled<Real>(best.normal, best.bound / length(best.normal)));
  return {{best.bound - rounding, best.bound + rounding, false},
          in_model(best.boundary_point),
          2 * length(difference(foot, best.boundary_point)) + rounding};
}

}  // namespace verisq::oracle
