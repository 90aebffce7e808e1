/// Triangles that the plane cuts are chained through the edges that it cuts, downward into each and upward out of it.
#include "host/features/plane_section.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "host/mesh/eigen_points.hpp"

namespace verisq::features {
namespace {

using Eigen::Vector3d;

std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
  return (std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b);
}

/// Where the curve enters a triangle, and how it goes on.
struct Crossing {
  Vector3d point;
  std::uint64_t next;
};

class Cut {
 public:
  Cut(const Mesh& mesh, const Plane& plane) : mesh_(mesh) {
    heights_.reserve(mesh.vertices.size());
    for (const Point& x : mesh.vertices) heights_.push_back(plane.normal.dot(vector_of(x)) - plane.offset);
    for (const auto& triangle : mesh.triangles) add(triangle);
  }

  /// Takes a closed curve out, or an open one, of which it returns nothing; empty when there is none left.
  std::vector<std::vector<Vector3d>> curves() {
    std::vector<std::vector<Vector3d>> result;
    while (!crossings_.empty()) {
      const std::uint64_t start = crossings_.begin()->first;
      std::vector<Vector3d> points;
      std::uint64_t at = start;
      for (auto found = crossings_.find(at); found != crossings_.end(); found = crossings_.find(at)) {
        points.push_back(found->second.point);
        at = found->second.next;
        crossings_.erase(found);
      }
      if (at == start && points.size() > 2) result.push_back(std::move(points));
    }
    return result;
  }

 private:
  [[nodiscard]] bool above(std::uint32_t vertex) const { return heights_[vertex] >= 0.0; }

  [[nodiscard]] Vector3d crossing(std::uint32_t a, std::uint32_t b) const {
    const double t = heights_[a] / (heights_[a] - heights_[b]);
    return vector_of(mesh_.vertices[a]) + t * (vector_of(mesh_.vertices[b]) - vector_of(mesh_.vertices[a]));
  }

  void add(const std::array<std::uint32_t, 3>& triangle) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i];
      const std::uint32_t b = triangle[(i + 1) % 3];
      const std::uint32_t c = triangle[(i + 2) % 3];
      if (!above(a) || above(b)) continue;  // not downward through this edge
      const std::uint64_t next = above(c) ? edge_key(b, c) : edge_key(c, a);
      crossings_.insert({edge_key(a, b), {crossing(std::min(a, b), std::max(a, b)), next}});
    }
  }

  const Mesh& mesh_;
  std::vector<double> heights_;
  std::unordered_map<std::uint64_t, Crossing> crossings_;
};

SectionCurve measured(std::vector<Vector3d> points, const Vector3d& normal) {
  SectionCurve curve{0.0, 0.0, Vector3d::Zero(), {}};
  const Vector3d origin = points.front();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d a = points[i] - origin;
    const Vector3d b = points[(i + 1) % points.size()] - origin;
    const double area = 0.5 * normal.dot(a.cross(b));
    curve.perimeter += (b - a).norm();
    curve.area += area;
    curve.centroid += area / 3.0 * (a + b);
  }
  curve.centroid = curve.area != 0.0 ? Vector3d(origin + curve.centroid / curve.area) : origin;
  curve.points = std::move(points);
  return curve;
}

}  // namespace

std::vector<SectionCurve> plane_section(const Mesh& mesh, const Plane& plane) {
  std::vector<SectionCurve> result;
  for (std::vector<Vector3d>& points : Cut(mesh, plane).curves())
    result.push_back(measured(std::move(points), plane.normal));
  return result;
}

bool encloses(const SectionCurve& curve, const Plane& plane, const Vector3d& point) {
  const Vector3d u = plane.normal.unitOrthogonal();
  const Vector3d v = plane.normal.cross(u);
  bool inside = false;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Vector3d a = curve.points[i] - point;
    const Vector3d b = curve.points[(i + 1) % curve.points.size()] - point;
    if ((a.dot(v) > 0.0) == (b.dot(v) > 0.0)) continue;
    const double at = a.dot(u) - a.dot(v) * (b.dot(u) - a.dot(u)) / (b.dot(v) - a.dot(v));
    if (at > 0.0) inside = !inside;
  }
  return inside;
}

}  // namespace verisq::features
