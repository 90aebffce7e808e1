/// Halves by the middle of the longest side of the centroids' box; the nearer child first.
#include "host/recovery/triangle_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace verisq::recovery {
namespace {

constexpr std::uint32_t leaf_size = 4;

double squared_distance_to_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double t = std::clamp(along.dot(point - a) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
  return (a + t * along - point).squaredNorm();
}

double squared_distance(const Eigen::Vector3d& point, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  bool above = true;  // the foot on the plane lies in the triangle
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d& a = corners[i];
    const Eigen::Vector3d& b = corners[(i + 1) % 3];
    above = above && normal.dot((b - a).cross(point - a)) >= 0.0;
    nearest = std::min(nearest, squared_distance_to_segment(point, a, b));
  }
  if (!above) return nearest;
  const double height = normal.dot(point - corners[0]);
  return std::min(nearest, height * height / std::max(normal.squaredNorm(), 1e-300));
}

double squared_distance_to_box(const Eigen::Vector3d& point, const Eigen::Vector3d& lowest,
                               const Eigen::Vector3d& highest) {
  return (point - point.cwiseMax(lowest).cwiseMin(highest)).squaredNorm();
}

Eigen::Vector3d centroid(const std::array<Eigen::Vector3d, 3>& corners) {
  return (corners[0] + corners[1] + corners[2]) / 3.0;
}

}  // namespace

TriangleTree::TriangleTree(const Mesh& mesh) {
  triangles_.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles)
    triangles_.push_back({Eigen::Vector3d(mesh.vertices[triangle[0]].data()),
                          Eigen::Vector3d(mesh.vertices[triangle[1]].data()),
                          Eigen::Vector3d(mesh.vertices[triangle[2]].data())});
  nodes_.emplace_back();
  divide(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void TriangleTree::divide(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Node made{.lowest = Eigen::Vector3d::Constant(infinity),
            .highest = Eigen::Vector3d::Constant(-infinity),
            .first = first,
            .count = last - first};
  Eigen::Vector3d low = made.lowest;
  Eigen::Vector3d high = made.highest;
  for (std::uint32_t i = first; i < last; ++i) {
    for (const Eigen::Vector3d& corner : triangles_[i]) {
      made.lowest = made.lowest.cwiseMin(corner);
      made.highest = made.highest.cwiseMax(corner);
    }
    low = low.cwiseMin(centroid(triangles_[i]));
    high = high.cwiseMax(centroid(triangles_[i]));
  }
  if (made.count > leaf_size) {
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::uint32_t middle = first + made.count / 2;
    std::nth_element(triangles_.begin() + first, triangles_.begin() + middle, triangles_.begin() + last,
                     [axis](const auto& a, const auto& b) { return centroid(a)[axis] < centroid(b)[axis]; });
    made.first = static_cast<std::uint32_t>(nodes_.size());
    made.count = 0;
    nodes_.resize(nodes_.size() + 2);
    divide(made.first, first, middle);
    divide(made.first + 1, middle, last);
  }
  nodes_[node] = made;
}

double TriangleTree::distance(const Eigen::Vector3d& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::uint32_t>> open{{0.0, 0}};
  while (!open.empty()) {
    const auto [bound, index] = open.back();
    open.pop_back();
    if (bound >= nearest) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        nearest = std::min(nearest, squared_distance(point, triangles_[i]));
      continue;
    }
    std::array<std::pair<double, std::uint32_t>, 2> children;
    for (std::uint32_t side = 0; side < 2; ++side) {
      const Node& child = nodes_[node.first + side];
      children[side] = {squared_distance_to_box(point, child.lowest, child.highest), node.first + side};
    }
    if (children[0].first < children[1].first) std::swap(children[0], children[1]);
    open.push_back(children[0]);
    open.push_back(children[1]);
  }
  return std::sqrt(nearest);
}

}  // namespace verisq::recovery
