/// Points as Eigen's vectors, and moments of surfaces.
#pragma once

#include <Eigen/Core>
#include <Eigen/Dense>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

// Points as Eigen's vectors, and back.

[[nodiscard]] inline Eigen::Vector3d vector_of(const Point& p) {
  return {p[0], p[1], p[2]};
}

[[nodiscard]] inline Point point_of(const Eigen::Vector3d& v) {
  return {v[0], v[1], v[2]};
}

// Mean and covariance of a mesh's surface.

/// Sums of masses, of places and of their products.
struct SurfaceMoments {
  double mass = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  void add(double m, const Eigen::Vector3d& x) {
    mass += m;
    first += m * x;
    second += m * x * x.transpose();
  }
  [[nodiscard]] Eigen::Vector3d mean() const { return mass > 0.0 ? Eigen::Vector3d(first / mass) : first; }
  [[nodiscard]] Eigen::Matrix3d covariance() const {
    return mass > 0.0 ? Eigen::Matrix3d(second / mass - mean() * mean().transpose()) : second;
  }
};

/// Triangles count by their area, each at its centroid; without any, the vertices.
[[nodiscard]] inline SurfaceMoments surface_moments(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh) {
  SurfaceMoments moments;
  for (const auto& [i, j, k] : mesh.triangles) {
    const double area = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]).norm() / 2.0;
    moments.add(area, (vertices[i] + vertices[j] + vertices[k]) / 3.0);
  }
  if (moments.mass > 0.0) return moments;
  for (const Eigen::Vector3d& vertex : vertices) moments.add(1.0, vertex);
  return moments;
}

}  // namespace verisq
