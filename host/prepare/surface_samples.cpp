/// This file implements surface_samples.hpp.
#include "host/prepare/surface_samples.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>

#include "host/prepare/surface_distance.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::recovery {
namespace {

/// Gauge of semi-axes 1, and its gradient.
double unit_gauge(const Eigen::Vector3d& point, const Eigen::Vector2d& exponents, Eigen::Vector3d& gradient) {
  const Eigen::Vector3d size = point.cwiseAbs().cwiseMax(1e-30);
  const auto norm = [](double a, double b, double power, double& by_a, double& by_b) {
    const double larger = std::max(a, b);
    const double value = larger * std::pow(std::pow(a / larger, power) + std::pow(b / larger, power), 1.0 / power);
    by_a = std::pow(a / value, power - 1.0);
    by_b = std::pow(b / value, power - 1.0);
    return value;
  };
  double section_by_x = 0.0;
  double section_by_y = 0.0;
  double by_section = 0.0;
  const double section = norm(size[0], size[1], 2.0 / exponents[1], section_by_x, section_by_y);
  const double gauge = norm(section, size[2], 2.0 / exponents[0], by_section, gradient[2]);
  gradient[0] = by_section * section_by_x;
  gradient[1] = by_section * section_by_y;
  return gauge;
}

/// The deformed point of the straight solid of Eq. (1), in its own frame.
Eigen::Vector3d deformed(const Eigen::Vector3d& point, const Shape& shape) {
  const double k = shape.taper;
  const double height = point[2] / shape.axes[2];
  const double moved = (height - k) / (1.0 - k * height);  // z'/a3 of Superquadric's comment
  const double scale = 1.0 + k * moved;
  const Eigen::Vector3d tapered(scale * point[0], scale * point[1], shape.axes[2] * moved);
  const double curvature = shape.curvature.norm();
  if (curvature == 0.0) return tapered;
  const Eigen::Vector2d direction = shape.curvature / curvature;
  const double r = direction.dot(tapered.head<2>());
  const double s = direction[0] * tapered[1] - direction[1] * tapered[0];
  const double radius = 1.0 / curvature - r;
  const double bent_r = 1.0 / curvature - radius * std::cos(curvature * tapered[2]);
  return {direction[0] * bent_r - direction[1] * s, direction[1] * bent_r + direction[0] * s,
          radius * std::sin(curvature * tapered[2])};
}

}  // namespace

std::vector<Eigen::Vector3d> sample_surface(const Shape& shape, std::size_t count, std::mt19937_64& random) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(count);
  const Eigen::Vector3d reciprocal = shape.axes.cwiseInverse();
  // |s u| is at most sqrt 3, components of the gradient are at most 1.
  const double most = std::pow(3.0, 1.5) * reciprocal.norm();
  while (points.size() < count) {
    const double z = 2.0 * fraction(random) - 1.0;
    const double angle = 2.0 * std::numbers::pi * fraction(random);
    const double kept = fraction(random);
    const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
    const Eigen::Vector3d direction(radius * std::cos(angle), radius * std::sin(angle), z);
    Eigen::Vector3d gradient;
    const double s = 1.0 / unit_gauge(direction, shape.exponents, gradient);
    if (kept * most > s * s * s * gradient.cwiseProduct(reciprocal).norm()) continue;
    points.push_back(shape.centre + shape.rotation * deformed((s * direction).cwiseProduct(shape.axes), shape));
  }
  return points;
}

namespace {

/// At most about `count` points of the union's surface: points of its primitives that lie in no other primitive.
std::vector<Eigen::Vector3d> sample_union(std::span<const Shape> shapes, std::size_t count, std::mt19937_64& random) {
  std::vector<DistanceToShape> distances;
  for (const Shape& shape : shapes) distances.emplace_back(shape, Family::plain);
  double total = 0.0;
  const auto area = [](const Shape& shape) {
    return shape.axes[0] * shape.axes[1] + shape.axes[1] * shape.axes[2] + shape.axes[2] * shape.axes[0];
  };
  for (const Shape& shape : shapes) total += area(shape);
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const auto share = static_cast<std::size_t>(std::ceil(static_cast<double>(count) * area(shapes[i]) / total));
    for (const Eigen::Vector3d& point : sample_surface(shapes[i], share, random)) {
      bool covered = false;
      for (std::size_t j = 0; j < shapes.size() && !covered; ++j) covered = j != i && distances[j].value(point) < 0.0;
      if (!covered) points.push_back(point);
    }
  }
  return points;
}

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

namespace {

constexpr std::size_t neighbours = 9;  // in a neighbourhood of the middle size
constexpr std::size_t probes = 40;     // that size is measured at
constexpr double least_density = 0.4;  // of that which three quarters of the points keep below
constexpr double left_out = 0.01;      // on each side of a box
constexpr double least_half = 1e-12;   // of a box, of its largest

/// Squared; a neighbourhood of this radius holds `neighbours` points, in the middle.
double squared_radius(std::span<const Eigen::Vector3d> points) {
  const auto rank = static_cast<std::ptrdiff_t>(std::min(points.size() - 1, neighbours));
  std::vector<double> distances(points.size());
  std::vector<double> radii;
  for (std::size_t i = 0; i < std::min(points.size(), probes); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) distances[j] = (points[i] - points[j]).squaredNorm();
    std::nth_element(distances.begin(), distances.begin() + rank, distances.end());
    radii.push_back(distances[static_cast<std::size_t>(rank)]);
  }
  const auto middle = static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), radii.begin() + middle, radii.end());
  return radii[static_cast<std::size_t>(middle)];
}

}  // namespace

std::vector<Eigen::Vector3d> dense_points(std::span<const Eigen::Vector3d> points) {
  const double limit = squared_radius(points);
  const std::vector<std::int64_t> counts = counts_within(points, limit);
  std::vector<std::int64_t> sorted = counts;
  const std::size_t rank = sorted.size() * 3 / 4;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(rank), sorted.end());
  std::vector<Eigen::Vector3d> dense;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (static_cast<double>(counts[i]) >= least_density * static_cast<double>(sorted[rank])) dense.push_back(points[i]);
  return dense;
}

Eigen::Matrix3d principal_axes(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) covariance += (point - mean) * (point - mean).transpose();
  Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  return axes;
}

OrientedBox box_along(std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& axes) {
  std::vector<double> along(points.size());
  const auto drop = static_cast<std::size_t>(left_out * static_cast<double>(points.size()));
  OrientedBox box{};
  for (int i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < points.size(); ++k) along[k] = axes.col(i).dot(points[k]);
    const std::size_t last = along.size() - 1 - drop;
    std::nth_element(along.begin(), along.begin() + static_cast<std::ptrdiff_t>(drop), along.end());
    const double lowest = along[drop];
    std::nth_element(along.begin(), along.begin() + static_cast<std::ptrdiff_t>(last), along.end());
    box.centre[i] = 0.5 * (lowest + along[last]);
    box.half[i] = 0.5 * (along[last] - lowest);
  }
  box.centre = axes * box.centre;
  box.half = box.half.cwiseMax(std::max(least_half * box.half.maxCoeff(), 1e-300));
  return box;
}

namespace {

constexpr std::size_t samples_of_model = 20'000;  // of the model's surface
constexpr std::size_t piece = 512;                // points a thread takes at a time

EstimatedDeviation deviation_of(std::vector<double> distances) {
  const auto count = static_cast<double>(distances.size());
  EstimatedDeviation deviation{};
  for (const double distance : distances) {
    deviation.mean += distance / count;
    deviation.root_mean_square += distance * distance / count;
    deviation.largest = std::max(deviation.largest, distance);
  }
  deviation.root_mean_square = std::sqrt(deviation.root_mean_square);
  const auto rank = static_cast<std::ptrdiff_t>(0.95 * (count - 1.0));
  std::nth_element(distances.begin(), distances.begin() + rank, distances.end());
  deviation.percentile_95 = distances[static_cast<std::size_t>(rank)];
  return deviation;
}

/// `distance` of each point, by all threads.
template <typename Distance>
EstimatedDeviation deviation_of(std::span<const Eigen::Vector3d> points, const Distance& distance) {
  std::vector<double> distances(points.size());
  in_parallel((points.size() + piece - 1) / piece, [&](std::size_t part) {
    for (std::size_t i = part * piece; i < std::min(points.size(), (part + 1) * piece); ++i)
      distances[i] = distance(points[i]);
  });
  return deviation_of(std::move(distances));
}

/// The distances of the points to the boundary of the union of the shapes, to first order. Precondition: at least one
/// point.
EstimatedDeviation deviation_to_union(std::span<const Eigen::Vector3d> points, std::span<const Shape> shapes) {
  std::vector<DistanceToShape> to_shapes;
  for (const Shape& shape : shapes) to_shapes.emplace_back(shape, Family::plain);
  return deviation_of(points, [&to_shapes](const Eigen::Vector3d& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const DistanceToShape& to_shape : to_shapes) least = std::min(least, to_shape.value(point));
    return std::abs(least);
  });
}

/// The distances of samples of the union's boundary to the mesh; nothing if it has none.
std::optional<EstimatedDeviation> deviation_to_mesh(std::span<const Shape> shapes, const verify::TriangleTree& mesh,
                                                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<Eigen::Vector3d> points = sample_union(shapes, samples_of_model, random);
  if (points.empty()) return std::nullopt;
  return deviation_of(points, [&mesh](const Eigen::Vector3d& point) {
    return mesh.nearest({point[0], point[1], point[2]}).distance.hi;
  });
}

}  // namespace

RecoveryStage stage_of(std::span<const Shape> shapes, std::span<const Eigen::Vector3d> points,
                       const verify::TriangleTree* mesh, std::uint64_t seed) {
  RecoveryStage stage{.primitives = shapes.size(), .to_model = deviation_to_union(points, shapes)};
  if (mesh != nullptr) stage.to_mesh = deviation_to_mesh(shapes, *mesh, seed);
  return stage;
}

}  // namespace verisq::recovery
