/// Each sample within a triangle takes the mean of the corners weighted by barycentric coordinates.
#include "host/report/depth_buffer.hpp"

#include <algorithm>
#include <cmath>

namespace verisq::report {
namespace {

double cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double x, double y) {
  return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

}  // namespace

void DepthBuffer::draw(const ProjectedSurface& surface, double nearest) {
  for (const auto& triangle : surface.triangles) draw(surface, triangle, nearest);
}

void DepthBuffer::draw(const ProjectedSurface& surface, const std::array<std::uint32_t, 3>& triangle, double nearest) {
  const auto [i, j, k] = triangle;
  const Eigen::Vector3d& a = surface.vertices[i];
  const Eigen::Vector3d& b = surface.vertices[j];
  const Eigen::Vector3d& c = surface.vertices[k];
  const double area = cross(a, b, c[0], c[1]);  // of either sign: both sides are seen
  if (!std::isnormal(area)) return;             // seen edge-on; or corners beyond the range of numbers
  const auto [lowest_y, highest_y] = std::minmax({a[1], b[1], c[1]});
  const int first_row = static_cast<int>(std::max<double>(top_, std::floor(lowest_y)));
  const int last_row = static_cast<int>(std::min<double>(top_ + height_ - 1, std::floor(highest_y)));
  if (first_row > last_row) return;
  const auto [lowest_x, highest_x] = std::minmax({a[0], b[0], c[0]});
  const int first_column = static_cast<int>(std::max(0.0, std::floor(lowest_x)));
  const int last_column = static_cast<int>(std::min<double>(width_ - 1, std::floor(highest_x)));

  const auto mean = [](const Eigen::Vector3d& weights, double at_a, double at_b, double at_c) {
    return static_cast<float>(weights[0] * at_a + weights[1] * at_b + weights[2] * at_c);
  };
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const double x = column + 0.5;
      const double y = row + 0.5;
      const Eigen::Vector3d weights(cross(b, c, x, y) / area, cross(c, a, x, y) / area, cross(a, b, x, y) / area);
      // Edges belong to both triangles: no gaps, and the depth decides.
      if (weights.minCoeff() < 0.0) continue;
      const float depth = mean(weights, a[2], b[2], c[2]);
      Sample& sample = samples_[index(column, row)];
      if (depth > nearest || depth <= sample.depth) continue;
      sample = {depth, mean(weights, surface.facing[i], surface.facing[j], surface.facing[k]),
                surface.values.empty() ? 0.0F : mean(weights, surface.values[i], surface.values[j], surface.values[k])};
    }
  }
}

}  // namespace verisq::report
