/// A point inside and one outside: the surface passes between them. Where the normal of the triangle does not find it
/// (no area, a groove), the gradient may, and else one of many directions.
#include "host/tessellation/sampled_deviation.hpp"

#include <algorithm>
#include <vector>

namespace verisq::tessellation {
namespace {

/// From a cube's centre to its corners, edges and faces: no direction is farther than 28 degrees from one of them.
std::vector<Eigen::Vector3d> spread_directions() {
  std::vector<Eigen::Vector3d> directions;
  for (const int x : {-1, 0, 1}) {
    for (const int y : {-1, 0, 1}) {
      for (const int z : {-1, 0, 1}) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(Eigen::Vector3d(x, y, z).normalized());
      }
    }
  }
  return directions;
}

/// Whether a point at most `deviation` away lies on the other side of the surface.
bool is_near(const Solid& solid, const Eigen::Vector3d& point, const Eigen::Vector3d& normal, double deviation) {
  static const std::vector<Eigen::Vector3d> anywhere = spread_directions();
  const bool inside = solid.contains(point);
  const auto passes = [&](const Eigen::Vector3d& direction) {
    return solid.contains(point + deviation * direction) != inside;
  };
  const double out = inside ? 1.0 : -1.0;
  if (passes(out * normal) || passes(-out * normal)) return true;
  const Eigen::Vector3d gradient = solid.outward(point, deviation);
  return passes(out * gradient) || std::ranges::any_of(anywhere, passes);
}

}  // namespace

bool within(const Solid& solid, const TriangleCorners& triangle, double deviation, Sampling sampling) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3d normal = doubled_area(triangle).stableNormalized();
  const auto near_surface = [&](const Eigen::Vector3d& point) { return is_near(solid, point, normal, deviation); };
  if (!near_surface((a + b + c) / 3.0)) return false;
  const int steps = static_cast<int>(sampling);
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j <= steps - i; ++j) {
      const int k = steps - i - j;
      if (j == steps || k == steps || (i == j && j == k)) continue;
      if (!near_surface((i * a + j * b + k * c) / steps)) return false;
    }
  }
  return true;
}

double sampled_deviation(const Solid& solid, const TriangleCorners& triangle, double least, double most,
                         Sampling sampling) {
  double deviation = least;
  while (deviation < most && !within(solid, triangle, deviation, sampling)) deviation *= 1.125;
  return deviation < most ? deviation : most;
}

}  // namespace verisq::tessellation
