/// The head of a femur: the sphere that most of its surface covers.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <verisq/mesh.hpp>

namespace verisq::features {

struct HeadSphere {
  Eigen::Vector3d centre;
  double radius;
  double coverage;  ///< share of the sphere that is the mesh's surface
};

inline constexpr double smallest_head = 12.0;  // mm: of a child
inline constexpr double largest_head = 35.0;
/// Condyles cover less than a half of their spheres, heads more.
inline constexpr double least_head_coverage = 0.42;

/// The same for the same mesh. Precondition: triangles whose normals point outward.
[[nodiscard]] std::optional<HeadSphere> head_sphere(const Mesh& mesh);

}  // namespace verisq::features
