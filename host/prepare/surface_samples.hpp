/// Points of surfaces and of the space about them: how they are drawn, where they lie, how far apart two surfaces' are.
#pragma once

#include <Eigen/Core>
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

/// In [0, 1). std::mt19937_64 is fixed by the standard, its distributions are not.
[[nodiscard]] inline double fraction(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// `count` independent points, uniform by area where the shape is neither tapered nor bent: directions are drawn, and
/// kept in proportion to the area that they stand for. Tapers and bends then move them.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_surface(const Shape& shape, std::size_t count,
                                                          std::mt19937_64& random);

/// At most about `count` points of the union's surface: those of its primitives that lie in no other.
[[nodiscard]] std::vector<Eigen::Vector3d> sample_union(std::span<const Shape> shapes, std::size_t count,
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

// Where a cloud lies and how far it reaches: what the first shapes of a search are made of.

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

// How far samples of two surfaces lie apart, in floating point.

/// Of the points to the boundary of the union of the shapes, to first order. Precondition: at least one point.
[[nodiscard]] EstimatedDeviation deviation_to_union(std::span<const Eigen::Vector3d> points,
                                                    std::span<const Shape> shapes);

/// Of samples of the union's boundary to the mesh; nothing when it has none.
[[nodiscard]] std::optional<EstimatedDeviation> deviation_to_mesh(std::span<const Shape> shapes,
                                                                  const verify::TriangleTree& mesh, std::uint64_t seed);

/// Both. `mesh` may be null: a cloud has none.
[[nodiscard]] RecoveryStage stage_of(std::span<const Shape> shapes, std::span<const Eigen::Vector3d> points,
                                     const verify::TriangleTree* mesh, std::uint64_t seed);

}  // namespace verisq::recovery
