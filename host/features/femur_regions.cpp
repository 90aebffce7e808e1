/// By places along axes.
#include "host/features/femur_regions.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <verisq/enclosure.hpp>
#include <verisq/error.hpp>

#include "host/mesh/eigen_points.hpp"
#include "host/mesh/surface_moments.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

constexpr double head_share = 1.15;  // of its radius: its rim, where the neck begins
constexpr double neck_share = 0.9;

Vector3d centroid(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return (vector_of(mesh.vertices[triangle[0]]) + vector_of(mesh.vertices[triangle[1]]) +
          vector_of(mesh.vertices[triangle[2]])) /
         3.0;
}

}  // namespace

Regions femur_regions(const Mesh& mesh, const FemurLandmarks& landmarks) {
  const auto& [head_centre, head_radius, neck_centre, proximal, distal, a, b, c, d] = landmarks;
  if (!head_centre || !head_radius || !neck_centre || !proximal || !distal)
    throw Error(ErrorKind::input,
                "landmarks: regions need head_centre, head_radius, neck_centre and both of the shaft");
  const Vector3d head = vector_of(*head_centre);
  const Vector3d neck = (vector_of(*neck_centre) - head).normalized();  // towards the shaft
  const Vector3d low = vector_of(*distal);
  const Vector3d up = (vector_of(*proximal) - low).normalized();
  const double top = up.dot(vector_of(*proximal) - low);
  // Where the neck's axis passes the shaft's, the neck has ended.
  const Vector3d medial = (head - low) - up.dot(head - low) * up;
  const double towards_shaft = -neck.dot(medial.normalized());
  const double neck_length = towards_shaft > 0.0 ? medial.norm() / towards_shaft - *head_radius : 0.0;
  enum Region : std::uint32_t { of_head, of_neck, of_trochanters, of_shaft, of_condyles };
  Regions regions{{"head", "neck", "trochanters", "shaft", a ? "condyles" : "below the shaft"}, {}};
  for (const auto& triangle : mesh.triangles) {
    const Vector3d x = centroid(mesh, triangle);
    const double along_neck = neck.dot(x - head);
    const double from_neck = ((x - head) - along_neck * neck).norm();
    const double height = up.dot(x - low);
    Region region = of_trochanters;
    if ((x - head).norm() <= head_share * *head_radius) {
      region = of_head;
    } else if (height < 0.0) {
      region = of_condyles;
    } else if (height <= top) {
      region = of_shaft;
    } else if (along_neck > 0.0 && along_neck < neck_length && from_neck <= neck_share * *head_radius) {
      region = of_neck;
    }
    regions.of_triangles.push_back(region);
  }
  return regions;
}

Regions parts_along(const Mesh& mesh, std::uint32_t count) {
  std::vector<Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), vector_of);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(surface_moments(vertices, mesh).covariance());
  Vector3d axis = solver.eigenvectors().col(2);
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0.0) axis = -axis;
  double lowest = infinity;
  double highest = -infinity;
  for (const Vector3d& x : vertices) {
    lowest = std::min(lowest, axis.dot(x));
    highest = std::max(highest, axis.dot(x));
  }
  const double step = (highest - lowest) / count;
  Regions regions;
  for (std::uint32_t i = 0; i < count; ++i)
    regions.names.push_back(fmt::format("{:.5g} to {:.5g}", i * step, (i + 1) * step));
  for (const auto& triangle : mesh.triangles) {
    const double place = (axis.dot(centroid(mesh, triangle)) - lowest) / step;
    regions.of_triangles.push_back(std::min(count - 1, static_cast<std::uint32_t>(std::max(0.0, place))));
  }
  return regions;
}

}  // namespace verisq::features
