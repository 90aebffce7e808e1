/// Principal axes of the bone's surface.
#include "host/report/view.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "host/mesh/extent.hpp"
#include "host/mesh/surface_moments.hpp"

namespace verisq::report {
namespace {

/// `v` or -v, so that its largest coordinate is positive: the same view whatever the sign that the solver gave.
Eigen::Vector3d with_positive_side(const Eigen::Vector3d& v) {
  Eigen::Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  return v[largest] < 0.0 ? Eigen::Vector3d(-v) : v;
}

std::vector<Eigen::Vector3d> seen(const View& view, const Mesh& mesh) {
  std::vector<Eigen::Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), view);
  return vertices;
}

}  // namespace

Eigen::Vector3d surface_centroid(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh) {
  return surface_moments(vertices, mesh).mean();
}

View broad_view(const Mesh& bone, const Mesh& implant) {
  std::vector<Point> all = bone.vertices;
  all.insert(all.end(), implant.vertices.begin(), implant.vertices.end());
  const Extent extent = extent_of(all);
  const double half_size = extent.half_size();
  View view{Eigen::Matrix3d::Identity(), extent.centre(), half_size > 0.0 ? half_size : 1.0};

  const std::vector<Eigen::Vector3d> vertices = seen(view, bone);
  const SurfaceMoments moments = surface_moments(vertices, bone);
  // Eigenvalues rise: the last axis is the longest, across the first the bone is thinnest.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(moments.covariance());
  Eigen::Vector3d up = with_positive_side(principal.eigenvectors().col(2));
  double lowest = 0.0;
  double highest = 0.0;
  for (const Eigen::Vector3d& vertex : vertices) {
    lowest = std::min(lowest, up.dot(vertex));
    highest = std::max(highest, up.dot(vertex));
  }
  if (up.dot(surface_centroid(seen(view, implant), implant)) < (lowest + highest) / 2.0) up = -up;
  const Eigen::Vector3d towards = with_positive_side(principal.eigenvectors().col(0));
  view.axes << up.cross(towards).transpose(), up.transpose(), towards.transpose();
  return view;
}

}  // namespace verisq::report
