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

/// Columns by rising eigenvalue.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
}

View unturned(const Mesh& bone, const Mesh& implant) {
  std::vector<Point> all = bone.vertices;
  all.insert(all.end(), implant.vertices.begin(), implant.vertices.end());
  const Extent extent = extent_of(all);
  const double half_size = extent.half_size();
  return {Eigen::Matrix3d::Identity(), extent.centre(), half_size > 0.0 ? half_size : 1.0};
}

}  // namespace

Eigen::Vector3d surface_centroid(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh) {
  return surface_moments(vertices, mesh).mean();
}

Eigen::Vector3d upright(const Mesh& bone, const Mesh& implant, const std::optional<Point>& asked) {
  if (asked) return Eigen::Vector3d((*asked)[0], (*asked)[1], (*asked)[2]).stableNormalized();
  const View view = unturned(bone, implant);
  const std::vector<Eigen::Vector3d> vertices = seen(view, bone);
  // Eigenvalues rise: the last axis is the longest.
  const Eigen::Vector3d up = with_positive_side(principal_axes(surface_moments(vertices, bone).covariance()).col(2));
  double lowest = 0.0;
  double highest = 0.0;
  for (const Eigen::Vector3d& vertex : vertices) {
    lowest = std::min(lowest, up.dot(vertex));
    highest = std::max(highest, up.dot(vertex));
  }
  const double implant_height = up.dot(surface_centroid(seen(view, implant), implant));
  return implant_height < lowest + (highest - lowest) / 3.0 ? Eigen::Vector3d(-up) : up;
}

View broad_view(const Mesh& bone, const Mesh& implant, const Eigen::Vector3d& up) {
  View view = unturned(bone, implant);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - up * up.transpose();
  const Eigen::Matrix3d covariance = surface_moments(seen(view, bone), bone).covariance();
  // Upright itself has the eigenvalue 0 and comes first; across the second axis the bone is thinnest. Where it is as
  // thin as that along all of them, the solver's axes may lean, hence the two cross products.
  const Eigen::Vector3d thinnest = with_positive_side(principal_axes(across * covariance * across).col(1));
  const Eigen::Vector3d right = up.cross(thinnest).norm() > 0.5 ? Eigen::Vector3d(up.cross(thinnest).normalized())
                                                                : Eigen::Vector3d(up.unitOrthogonal());
  view.axes << right.transpose(), up.transpose(), right.cross(up).transpose();
  return view;
}

}  // namespace verisq::report
