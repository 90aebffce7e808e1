/// Deviations by dense samples in long double: what proven ones must contain. Shares nothing with verify/.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::testing {

using Long = long double;
using LongPoint = std::array<Long, 3>;

inline LongPoint difference(const LongPoint& a, const LongPoint& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Long dot(const LongPoint& a, const LongPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline LongPoint cross(const LongPoint& a, const LongPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline LongPoint widened(const Point& p) {
  return {p[0], p[1], p[2]};
}
inline Point rounded(const LongPoint& p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

inline Long distance_to_side(const LongPoint& p, const LongPoint& a, const LongPoint& b) {
  const LongPoint side = difference(b, a);
  const Long squared = dot(side, side);
  const Long share = squared > 0 ? std::clamp(dot(difference(p, a), side) / squared, Long(0), Long(1)) : Long(0);
  const LongPoint foot{a[0] + share * side[0], a[1] + share * side[1], a[2] + share * side[2]};
  const LongPoint way = difference(p, foot);
  return std::sqrt(dot(way, way));
}

/// From the plane where the foot lies inside, else from the nearest side.
inline Long distance_to_triangle(const Point& point, const Triangle& triangle) {
  const LongPoint p = widened(point);
  const std::array corners{widened(triangle[0]), widened(triangle[1]), widened(triangle[2])};
  const Long to_sides =
      std::min({distance_to_side(p, corners[0], corners[1]), distance_to_side(p, corners[1], corners[2]),
                distance_to_side(p, corners[2], corners[0])});
  const LongPoint normal = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
  const Long squared = dot(normal, normal);
  if (squared == 0) return to_sides;
  for (std::size_t i = 0; i < 3; ++i) {
    if (dot(cross(difference(corners[(i + 1) % 3], corners[i]), difference(p, corners[i])), normal) < 0)
      return to_sides;
  }
  return std::abs(dot(difference(p, corners[0]), normal)) / std::sqrt(squared);
}

inline Triangle corners_of(const Mesh& mesh, std::size_t n) {
  const auto& [a, b, c] = mesh.triangles[n];
  return {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
}

inline Long distance_to_mesh(const Point& point, const Mesh& mesh) {
  Long nearest = HUGE_VALL;
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    nearest = std::min(nearest, distance_to_triangle(point, corners_of(mesh, n)));
  }
  return nearest;
}

/// Where taper, bend and pose take a point of the primitive's own frame, given in semi-axes.
inline Point placed(const Primitive& primitive, LongPoint unit) {
  const auto& [axes, exponents, taper] = primitive.superquadric;
  const Long k = (Long(taper) - 1) / (Long(taper) + 1);
  const Long height = (unit[2] - k) / (1 - k * unit[2]);
  const Long scale = 1 + k * height;
  LongPoint x{scale * unit[0] * axes[0], scale * unit[1] * axes[1], height * axes[2]};
  if (primitive.bend && primitive.bend->curvature != 0.0) {
    const Long curvature = primitive.bend->curvature;
    const Long angle = Long(primitive.bend->angle_degrees) * std::numbers::pi_v<Long> / 180;
    const Long r = x[0] * std::cos(angle) + x[1] * std::sin(angle);
    const Long s = x[1] * std::cos(angle) - x[0] * std::sin(angle);
    const Long along = 1 / curvature - (1 / curvature - r) * std::cos(curvature * x[2]);
    const Long up = (1 / curvature - r) * std::sin(curvature * x[2]);
    x = {along * std::cos(angle) - s * std::sin(angle), along * std::sin(angle) + s * std::cos(angle), up};
  }
  const auto& [w, i, j, l] = primitive.pose.quaternion;
  const LongPoint v{i, j, l};
  const Long squared = Long(w) * w + dot(v, v);
  const LongPoint once = cross(v, x);
  const LongPoint twice = cross(v, once);
  LongPoint result;
  for (std::size_t n = 0; n < 3; ++n) {
    result[n] = x[n] + 2 * (Long(w) * once[n] + twice[n]) / squared + primitive.pose.translation[n];
  }
  return rounded(result);
}

/// The point of |x|^(2/e) + |y|^(2/e) = 1 towards (x, y).
inline std::array<Long, 2> on_curve(Long x, Long y, double exponent) {
  const Long larger = std::max(std::abs(x), std::abs(y));
  const Long smaller = std::min(std::abs(x), std::abs(y));
  const Long gauge = larger * std::pow(1 + std::pow(smaller / larger, 2 / Long(exponent)), Long(exponent) / 2);
  return {x / gauge, y / gauge};
}

/// Angles in radians: latitude from -π/2 to π/2, longitude.
inline Point surface_point(const Primitive& primitive, Long latitude, Long longitude) {
  const auto& exponents = primitive.superquadric.exponents;
  const auto along = on_curve(std::cos(latitude), std::sin(latitude), exponents[0]);
  const auto around = on_curve(std::cos(longitude), std::sin(longitude), exponents[1]);
  return placed(primitive, {along[0] * around[0], along[0] * around[1], along[1]});
}

/// Closed, with its vertices on the surface: bands of latitude and longitude.
inline Mesh surface_mesh(const Primitive& primitive, std::uint32_t bands) {
  const Long pi = std::numbers::pi_v<Long>;
  const std::uint32_t around = 2 * bands;
  Mesh mesh{.vertices = {surface_point(primitive, -pi / 2, 0)}, .triangles = {}};
  for (std::uint32_t i = 1; i < bands; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      mesh.vertices.push_back(surface_point(primitive, pi * i / bands - pi / 2, 2 * pi * j / around));
    }
  }
  mesh.vertices.push_back(surface_point(primitive, pi / 2, 0));
  const auto index = [&](std::uint32_t i, std::uint32_t j) { return 1 + (i - 1) * around + j % around; };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (std::uint32_t j = 0; j < around; ++j) {
    mesh.triangles.push_back({0, index(1, j + 1), index(1, j)});
    mesh.triangles.push_back({last, index(bands - 1, j), index(bands - 1, j + 1)});
    for (std::uint32_t i = 1; i + 1 < bands; ++i) {
      mesh.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
    }
  }
  return mesh;
}

/// Points of a triangle on a grid, corners included, all of the same weight but those on the sides.
inline std::vector<Point> grid_on(const Triangle& triangle, int steps) {
  std::vector<Point> points;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      LongPoint p;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = (Long(i) * triangle[0][k] + Long(j) * triangle[1][k] + Long(steps - i - j) * triangle[2][k]) / steps;
      }
      points.push_back(rounded(p));
    }
  }
  return points;
}

}  // namespace verisq::testing
