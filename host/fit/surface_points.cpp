/// Grids over triangles.
#include "host/fit/surface_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "host/mesh/eigen_points.hpp"

namespace verisq::fit_search {
namespace {

/// A patch: grids of so many points either side of the middle, each this much finer than the outermost.
constexpr int patch_reach = 2;
constexpr std::array patch_scales{1.0, 4.0, 16.0};

double length(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Parts that the sides of a triangle are cut into.
double parts(const Cavity& cavity, const std::array<std::uint32_t, 3>& triangle, double spacing) {
  const Point& a = cavity.points[triangle[0]];
  const Point& b = cavity.points[triangle[1]];
  const Point& c = cavity.points[triangle[2]];
  return std::max(std::ceil(std::max({length(a, b), length(b, c), length(c, a)}) / spacing), 1.0);
}

double number_of_points(const Cavity& cavity, double spacing) {
  double number = 0.0;
  for (const auto& triangle : cavity.triangles) {
    const double n = parts(cavity, triangle, spacing);
    number += (n + 1.0) * (n + 2.0) / 2.0 - 3.0;
  }
  return number;
}

void add_grid(Cavity& cavity, const std::array<std::uint32_t, 3>& triangle, double spacing) {
  const auto n = static_cast<int>(parts(cavity, triangle, spacing));
  const auto [a, b, c] = std::array{cavity.points[triangle[0]], cavity.points[triangle[1]], cavity.points[triangle[2]]};
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      if (i == n || j == n || i + j == 0) continue;  // the corners are there
      const double of_b = static_cast<double>(i) / n;
      const double of_c = static_cast<double>(j) / n;
      Point point;
      for (std::size_t k = 0; k < 3; ++k) point[k] = a[k] + of_b * (b[k] - a[k]) + of_c * (c[k] - a[k]);
      cavity.points.push_back(point);
    }
  }
}

}  // namespace

std::vector<Point> patch(const Triangle& triangle, const Point& middle, double spacing) {
  const Eigen::Vector3d a = vector_of(triangle[0]);
  const Eigen::Vector3d ab = vector_of(triangle[1]) - a;
  const Eigen::Vector3d ac = vector_of(triangle[2]) - a;
  const Eigen::Vector3d normal = ab.cross(ac);
  const Eigen::Vector3d along = ab.normalized();
  const Eigen::Vector3d across = normal.cross(ab).normalized();
  const auto in_triangle = [&](const Eigen::Vector3d& x) {
    const double of_b = (x - a).cross(ac).dot(normal) / normal.squaredNorm();
    const double of_c = ab.cross(x - a).dot(normal) / normal.squaredNorm();
    return of_b >= 0.0 && of_c >= 0.0 && of_b + of_c <= 1.0;
  };
  std::vector<Point> points{middle};
  for (const double finer : patch_scales) {
    for (int i = -patch_reach; i <= patch_reach; ++i) {
      for (int j = -patch_reach; j <= patch_reach; ++j) {
        const Eigen::Vector3d x = vector_of(middle) + spacing / finer * (i * along + j * across);
        if ((i != 0 || j != 0) && in_triangle(x)) points.push_back({x[0], x[1], x[2]});
      }
    }
  }
  return points;
}

Cavity with_surface_points(const Cavity& cavity, double spacing, std::size_t most_points) {
  Cavity result = cavity;
  if (cavity.triangles.empty()) return result;
  while (number_of_points(cavity, spacing) > static_cast<double>(most_points) &&
         number_of_points(cavity, 2.0 * spacing) < number_of_points(cavity, spacing))
    spacing *= 2.0;
  for (const auto& triangle : cavity.triangles) add_grid(result, triangle, spacing);
  result.areas.push_back({"between the points", 0.0});
  result.area_of.resize(result.points.size(), static_cast<std::uint32_t>(result.areas.size() - 1));
  return result;
}

}  // namespace verisq::fit_search
