/// Points of surfaces and of the space about them: how they are drawn, where they lie, and sums over many of them at
/// once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/recovery.hpp>

#include "host/prepare/surface_distance.hpp"
#include "verify/proof/triangle_tree.hpp"

namespace verisq::recovery {

// Points spread evenly over the surface of a shape.

/// A number in [0, 1). The standard fixes std::mt19937_64, but not its distributions.
[[nodiscard]] inline double fraction(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// `count` independent points, uniform by area if the shape is neither tapered nor bent. Directions are drawn, and kept
/// in proportion to the area that they represent. Tapers and bends then move the points.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_surface(const Shape& shape, std::size_t count,
                                                          std::mt19937_64& random);

// Points of a mesh's surface and of the space about it.

/// Independent, uniform by area. Precondition: a triangle of positive area.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_mesh(const Mesh& mesh, std::size_t count, std::mt19937_64& random);

/// A regular grid of the mesh's box and a step around it, and a coarser one farther out.
struct GridSample {
  std::vector<Eigen::Vector3d> inside;
  std::vector<Eigen::Vector3d> outside;
  double step;
};

/// About `count` points, and as many around; inside are those above an odd number of triangles. Precondition: a closed
/// mesh.
[[nodiscard]] GridSample sample_space(const Mesh& mesh, std::size_t count);

// The place and extent of a cloud: the first shapes of a search are made from them.

/// The points whose neighbourhoods are nearly as dense as most others': on a surface, not strewn about it. Compares all
/// pairs: for thousands of points at most.
[[nodiscard]] std::vector<Eigen::Vector3d> dense_points(std::span<const Eigen::Vector3d> points);

/// Principal axes as columns, right-handed, by ascending variance. Precondition: at least one point.
[[nodiscard]] Eigen::Matrix3d principal_axes(std::span<const Eigen::Vector3d> points);

/// A box that holds nearly all points, along the columns of `axes`.
struct OrientedBox {
  Eigen::Vector3d centre;
  Eigen::Vector3d half;  ///< positive
};

/// Leaves out one point in a hundred on each side. Precondition: at least one point.
[[nodiscard]] OrientedBox box_along(std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& axes);

// The distances of samples of two surfaces, in floating point.

/// Both deviations. `mesh` may be null, for a cloud.
[[nodiscard]] RecoveryStage stage_of(std::span<const Shape> shapes, std::span<const Eigen::Vector3d> points,
                                     const verify::TriangleTree* mesh, std::uint64_t seed);

// The normal equations of a straight shape over many points at once: eight at a time, for the vectors of any
// processor, with the same bits on all of them.

inline constexpr std::size_t lanes = 8;

/// Eight points; `present` is 0 for those that only fill up the last block.
struct PointBlock {
  alignas(64) std::array<double, lanes> x;
  alignas(64) std::array<double, lanes> y;
  alignas(64) std::array<double, lanes> z;
  alignas(64) std::array<double, lanes> present;
};

[[nodiscard]] std::vector<PointBlock> blocks_of(std::span<const Eigen::Vector3d> points);

/// For each point, the number of points, itself included, that are nearer than the root of `squared_radius`.
[[nodiscard]] std::vector<std::int64_t> counts_within(std::span<const Eigen::Vector3d> points, double squared_radius);

/// An inlier's likelihood at the distance r is exp(-precision r^2), an outlier's is `ratio`.
struct MixtureTerms {
  double precision;
  double ratio;
};

inline constexpr std::size_t straight_parameters = 12;

/// -ln of the likelihood, summed, and the sums of w and w r^2.
struct MixtureSums {
  double cost = 0.0;
  double weights = 0.0;
  double squares = 0.0;
};

/// Over all points, w the probability to be an inlier, J the derivatives by the first twelve parameters of Step.
struct WeightedSums {
  MixtureSums mixture;
  std::array<double, straight_parameters> gradient{};                                 ///< of w r J
  std::array<std::array<double, straight_parameters>, straight_parameters> matrix{};  ///< of w J J^T, upper triangle
};

/// Also writes the distances r: eight a block. The taper varies only where `tapers`.
[[nodiscard]] WeightedSums weighted_sums(std::span<const PointBlock> blocks, const Shape& shape, bool tapers,
                                         const MixtureTerms& terms, std::span<double> distances);

/// The distances alone.
void distances_to(std::span<const PointBlock> blocks, const Shape& shape, std::span<double> distances);

/// Along the shape's axes, from the least to the greatest coordinate of the points whose distances are no larger than
/// `farthest`; -infinity if there are none.
[[nodiscard]] Eigen::Vector3d extent_of(std::span<const PointBlock> blocks, const Shape& shape,
                                        std::span<const double> distances, double farthest);

[[nodiscard]] MixtureSums mixture_sums(std::span<const PointBlock> blocks, const MixtureTerms& terms,
                                       std::span<const double> distances);

}  // namespace verisq::recovery
