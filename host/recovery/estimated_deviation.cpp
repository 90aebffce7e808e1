/// Means and percentiles of sampled distances.
#include "host/recovery/estimated_deviation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "host/recovery/superquadric_sample.hpp"
#include "host/recovery/surface_distance.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::recovery {
namespace {

constexpr std::size_t samples = 20'000;  // of the model's surface
constexpr std::size_t piece = 512;       // points a thread takes at a time

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

}  // namespace

EstimatedDeviation deviation_to_union(std::span<const Eigen::Vector3d> points, std::span<const Shape> shapes) {
  std::vector<DistanceToShape> to_shapes;
  for (const Shape& shape : shapes) to_shapes.emplace_back(shape, Family::plain);
  return deviation_of(points, [&to_shapes](const Eigen::Vector3d& point) {
    double least = std::numeric_limits<double>::infinity();
    for (const DistanceToShape& to_shape : to_shapes) least = std::min(least, to_shape.value(point));
    return std::abs(least);
  });
}

std::optional<EstimatedDeviation> deviation_to_mesh(std::span<const Shape> shapes, const verify::TriangleTree& mesh,
                                                    std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const std::vector<Eigen::Vector3d> points = sample_union(shapes, samples, random);
  if (points.empty()) return std::nullopt;
  return deviation_of(points, [&mesh](const Eigen::Vector3d& point) {
    return mesh.nearest({point[0], point[1], point[2]}).distance.hi;
  });
}

RecoveryStage stage_of(std::span<const Shape> shapes, std::span<const Eigen::Vector3d> points,
                       const verify::TriangleTree* mesh, std::uint64_t seed) {
  RecoveryStage stage{.primitives = shapes.size(), .to_model = deviation_to_union(points, shapes)};
  if (mesh != nullptr) stage.to_mesh = deviation_to_mesh(shapes, *mesh, seed);
  return stage;
}

}  // namespace verisq::recovery
