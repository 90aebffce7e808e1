/// Principal axes of the bone's surface.
#include "host/report/view.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "host/mesh/extent.hpp"

namespace verisq::report {
namespace {

struct Moments {
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
Moments moments_of(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh) {
  Moments moments;
  for (const auto& [i, j, k] : mesh.triangles) {
    const double area = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]).norm() / 2.0;
    moments.add(area, (vertices[i] + vertices[j] + vertices[k]) / 3.0);
  }
  if (moments.mass > 0.0) return moments;
  for (const Eigen::Vector3d& vertex : vertices) moments.add(1.0, vertex);
  return moments;
}

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
  return moments_of(vertices, mesh).mean();
}

View broad_view(const Mesh& bone, const Mesh& implant) {
  std::vector<Point> all = bone.vertices;
  all.insert(all.end(), implant.vertices.begin(), implant.vertices.end());
  const Extent extent = extent_of(all);
  const double half_size = extent.half_size();
  View view{Eigen::Matrix3d::Identity(), extent.centre(), half_size > 0.0 ? half_size : 1.0};

  const std::vector<Eigen::Vector3d> vertices = seen(view, bone);
  const Moments moments = moments_of(vertices, bone);
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
