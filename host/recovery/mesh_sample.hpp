/// Points of a mesh's surface and of the space about it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <random>
#include <vector>
#include <verisq/mesh.hpp>

namespace verisq::recovery {

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

}  // namespace verisq::recovery
