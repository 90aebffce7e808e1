/// Parallel projection, and the normals of smooth shading.
#include "host/report/projection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "verisq/enclosure.hpp"

namespace verisq::report {
namespace {

/// Cosines of the vertices' normals with the line of sight. A normal is the sum of those of the triangles around, each
/// as long as its area.
std::vector<float> facing(const std::vector<Eigen::Vector3d>& vertices,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Eigen::Vector3d> normals(vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [i, j, k] : triangles) {
    const Eigen::Vector3d normal = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]);
    for (const std::uint32_t corner : {i, j, k}) normals[corner] += normal;
  }
  std::vector<float> cosines(normals.size());
  std::ranges::transform(normals, cosines.begin(), [](const Eigen::Vector3d& normal) {
    return static_cast<float>(normal.stableNormalized()[2]);
  });
  return cosines;
}

}  // namespace

RasterTransform fitted(const View& view, const Mesh& bone, const Mesh& implant, double width, double height,
                       double margin) {
  Eigen::Array2d lower(infinity, infinity);
  Eigen::Array2d upper(-infinity, -infinity);
  for (const Mesh* mesh : {&bone, &implant}) {
    for (const Point& vertex : mesh->vertices) {
      const Eigen::Array2d place = view(vertex).head<2>().array();
      lower = lower.min(place);
      upper = upper.max(place);
    }
  }
  if (!(lower <= upper).all()) lower = upper = Eigen::Array2d::Zero();  // nothing to see
  const Eigen::Array2d room = (Eigen::Array2d(width, height) - 2.0 * margin).max(1.0);
  const Eigen::Array2d size = (upper - lower).max(std::numeric_limits<double>::min());
  const double scale = std::min((room / size).minCoeff(), room.maxCoeff());  // a single point stays one
  const Eigen::Array2d middle = (lower + upper) / 2.0;
  return {scale, middle[0] - width / 2.0 / scale, middle[1] + height / 2.0 / scale};
}

ProjectedSurface projected(const Mesh& mesh, std::vector<float> values, const View& view,
                           const RasterTransform& raster) {
  std::vector<Eigen::Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), view);
  std::vector<float> cosines = facing(vertices, mesh.triangles);
  for (Eigen::Vector3d& v : vertices) {
    v = raster.scale * Eigen::Vector3d(v[0] - raster.left, raster.top - v[1], v[2]);
  }
  return {std::move(vertices), std::move(cosines), std::move(values), mesh.triangles};
}

}  // namespace verisq::report
