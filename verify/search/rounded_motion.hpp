/// Rigid motions in binary64, and balls about triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

/// A rigid motion in binary64.
class RoundedMotion {
 public:
  explicit RoundedMotion(const RigidMotion& motion) {
    for (std::size_t i = 0; i < 3; ++i) {
      translation_[i] = motion.translation[i].lower().to_double(Direction::down);
      for (std::size_t j = 0; j < 3; ++j) rows_[i][j] = in_binary64(motion.rotation(i, j)).lower();
    }
    is_exact_ = is_identity(motion);
  }

  [[nodiscard]] Point operator()(const Point& x) const {
    if (is_exact_) return x;
    Point moved;
    for (std::size_t i = 0; i < 3; ++i)
      moved[i] = rows_[i][0] * x[0] + rows_[i][1] * x[1] + rows_[i][2] * x[2] + translation_[i];
    return moved;
  }

  [[nodiscard]] std::vector<Triangle> operator()(std::span<const Triangle> triangles) const {
    std::vector<Triangle> moved(triangles.begin(), triangles.end());
    for (Triangle& triangle : moved)
      for (Point& corner : triangle) corner = (*this)(corner);
    return moved;
  }

  /// Points whose coordinates are at most so large stay where differences are below 2^300: distances need that.
  [[nodiscard]] bool is_ordinary(double largest) const {
    return largest < 0x1p299 && (is_exact_ || displacement(largest) < 0x1p250);
  }

  /// No point whose coordinates are at most so large is moved farther from its exact place. Elements of the rotation
  /// are off by 2 u, the translation by 2 u of itself; products and three sums round by 4 u: a coordinate is off by
  /// less than 7 u (Σ|x| + |t|), the point by less than 13 u (3 largest + Σ|t|).
  [[nodiscard]] double displacement(double largest) const {
    if (is_exact_) return 0.0;
    const double sum = std::abs(translation_[0]) + std::abs(translation_[1]) + std::abs(translation_[2]);
    return 0x1p-49 * (3.0 * largest + sum) + 0x1p-1000;
  }

 private:
  static bool is_identity(const RigidMotion& motion) {
    const auto is = [](const PreciseInterval& x, int value) {
      return x.lower() == Real(value) && x.upper() == Real(value);
    };
    bool same = true;
    for (std::size_t i = 0; i < 3; ++i) {
      same = same && is(motion.translation[i], 0);
      for (std::size_t j = 0; j < 3; ++j) same = same && is(motion.rotation(i, j), i == j ? 1 : 0);
    }
    return same;
  }

  std::array<Point, 3> rows_;
  Point translation_;
  bool is_exact_ = false;
};

[[nodiscard]] inline RigidMotion motion_of(const PosedMesh& mesh) {
  return mesh.motion() ? *mesh.motion() : RigidMotion(Pose{});
}

[[nodiscard]] inline Enclosure widened_by(const Enclosure& distance, double displacement) {
  if (displacement == 0.0) return distance;
  const Interval widened = Interval(distance.lo, distance.hi) + Interval(-displacement, displacement);
  return {std::max(0.0, widened.lower()), widened.upper()};
}

inline constexpr Enclosure they_meet{0.0, 0.0};

[[nodiscard]] inline Enclosure least_of(const Enclosure& a, const Enclosure& b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}

struct BallAboutTriangle {
  Point centre;
  double radius;  ///< rounded up
};

[[nodiscard]] inline BallAboutTriangle ball_about(const Triangle& triangle) {
  BallAboutTriangle ball{{}, 0.0};
  for (const Point& corner : triangle)
    for (std::size_t i = 0; i < 3; ++i) ball.centre[i] += corner[i] / 3.0;
  for (const Point& corner : triangle) {
    const Point way = difference(corner, ball.centre);
    ball.radius = std::max(ball.radius, length(way[0], way[1], way[2]) * (1.0 + 0x1p-48) + 0x1p-1000);
  }
  return ball;
}

/// Bounds how far the centre of a ball about a triangle with no larger coordinate is from its middle: three quotients
/// and two sums round a coordinate by less than 4 u of it.
[[nodiscard]] inline double rounding_of_middle(double largest) {
  return 0x1p-50 * largest;
}

}  // namespace verisq::verify
