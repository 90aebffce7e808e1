/// Triangles by their areas; columns along z by parity.
#include "host/recovery/mesh_sample.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "host/recovery/superquadric_sample.hpp"

namespace verisq::recovery {
namespace {

// Columns stand off the grid, or they would hit the edges of meshes that are themselves made on one.
constexpr double offset_x = 0.3819660113;
constexpr double offset_y = 0.6180339887;
constexpr double offset_z = 0.4142135624;

Eigen::Vector3d corner(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle, std::size_t i) {
  return Eigen::Vector3d(mesh.vertices[triangle[i]].data());
}

/// Heights at which columns cross the mesh.
class Columns {
 public:
  Columns(const Mesh& mesh, const Eigen::Vector3d& lowest, const Eigen::Array3i& counts, double step)
      : lowest_(lowest),
        counts_(counts),
        step_(step),
        heights_(static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1])) {
    for (const auto& triangle : mesh.triangles)
      add({corner(mesh, triangle, 0), corner(mesh, triangle, 1), corner(mesh, triangle, 2)});
  }

  [[nodiscard]] double x(int i) const { return lowest_[0] + (i + offset_x) * step_; }
  [[nodiscard]] double y(int j) const { return lowest_[1] + (j + offset_y) * step_; }
  [[nodiscard]] bool inside(int i, int j, double z) const {
    const std::vector<double>& column = heights_[place(i, j)];
    return std::ranges::count_if(column, [z](double height) { return height < z; }) % 2 == 1;
  }

 private:
  [[nodiscard]] std::size_t place(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(counts_[1]) + static_cast<std::size_t>(j);
  }

  void add(const std::array<Eigen::Vector3d, 3>& corners) {
    const Eigen::Vector3d low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
    const Eigen::Vector3d high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
    const auto first = [this](double value, int axis, double offset) {
      return std::max(0, static_cast<int>(std::ceil((value - lowest_[axis]) / step_ - offset)));
    };
    for (int i = first(low[0], 0, offset_x); i < counts_[0] && x(i) <= high[0]; ++i)
      for (int j = first(low[1], 1, offset_y); j < counts_[1] && y(j) <= high[1]; ++j) cross(corners, i, j);
  }

  void cross(const std::array<Eigen::Vector3d, 3>& corners, int i, int j) {
    std::array<double, 3> weights{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& a = corners[(k + 1) % 3];
      const Eigen::Vector3d& b = corners[(k + 2) % 3];
      weights[k] = (a[0] - x(i)) * (b[1] - y(j)) - (b[0] - x(i)) * (a[1] - y(j));
    }
    const double sum = weights[0] + weights[1] + weights[2];
    if (sum == 0.0) return;
    double height = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (weights[k] / sum < 0.0) return;
      height += weights[k] / sum * corners[k][2];
    }
    heights_[place(i, j)].push_back(height);
  }

  Eigen::Vector3d lowest_;
  Eigen::Array3i counts_;
  double step_;
  std::vector<std::vector<double>> heights_;
};

/// A coarser grid around the box, out to as far again as half its extent.
void add_around(const Eigen::Vector3d& lowest, const Eigen::Vector3d& highest, double step,
                std::vector<Eigen::Vector3d>& outside) {
  const Eigen::Vector3d margin = 0.5 * (highest - lowest);
  const Eigen::Array3i counts = ((highest - lowest + 2.0 * margin).array() / step).ceil().cast<int>();
  for (int i = 0; i < counts[0]; ++i) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int k = 0; k < counts[2]; ++k) {
        const Eigen::Vector3d point =
            lowest - margin + step * Eigen::Vector3d(i + offset_x, j + offset_y, k + offset_z);
        if ((point.array() < lowest.array()).any() || (point.array() > highest.array()).any()) outside.push_back(point);
      }
    }
  }
}

}  // namespace

std::vector<Eigen::Vector3d> sample_mesh(const Mesh& mesh, std::size_t count, std::mt19937_64& random) {
  std::vector<double> areas;
  areas.reserve(mesh.triangles.size());
  double total = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = corner(mesh, triangle, 0);
    total += (corner(mesh, triangle, 1) - a).cross(corner(mesh, triangle, 2) - a).norm();
    areas.push_back(total);
  }
  std::vector<Eigen::Vector3d> points;
  points.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    // One in each of `count` equal parts of the area: more even than independent draws.
    const double at = total * (static_cast<double>(k) + fraction(random)) / static_cast<double>(count);
    const auto found = std::min(std::ranges::upper_bound(areas, at), areas.end() - 1);
    const auto& triangle = mesh.triangles[static_cast<std::size_t>(found - areas.begin())];
    double u = fraction(random);
    double v = fraction(random);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Eigen::Vector3d a = corner(mesh, triangle, 0);
    points.emplace_back(a + u * (corner(mesh, triangle, 1) - a) + v * (corner(mesh, triangle, 2) - a));
  }
  return points;
}

GridSample sample_space(const Mesh& mesh, std::size_t count) {
  Eigen::Vector3d lowest(mesh.vertices.front().data());
  Eigen::Vector3d highest = lowest;
  for (const Point& vertex : mesh.vertices) {
    lowest = lowest.cwiseMin(Eigen::Vector3d(vertex.data()));
    highest = highest.cwiseMax(Eigen::Vector3d(vertex.data()));
  }
  const double volume = (highest - lowest).cwiseMax(1e-3 * (highest - lowest).maxCoeff()).prod();
  const double step = std::cbrt(volume / static_cast<double>(count));
  lowest.array() -= step;
  const Eigen::Array3i counts = ((highest - lowest).array() / step).ceil().cast<int>() + 1;
  const Columns columns(mesh, lowest, counts, step);
  GridSample sample{.inside = {}, .outside = {}, .step = step};
  for (int i = 0; i < counts[0]; ++i) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int k = 0; k < counts[2]; ++k) {
        const Eigen::Vector3d point(columns.x(i), columns.y(j), lowest[2] + (k + offset_z) * step);
        (columns.inside(i, j, point[2]) ? sample.inside : sample.outside).push_back(point);
      }
    }
  }
  add_around(lowest, lowest + step * counts.cast<double>().matrix(), 2.0 * step, sample.outside);
  return sample;
}

}  // namespace verisq::recovery
