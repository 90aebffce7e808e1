/// Triangles are clipped one by one; those that share an edge share its new vertex.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <verisq/plane_cut.hpp>

namespace verisq {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

class Cutter {
 public:
  Cutter(const Mesh& mesh, const Plane& plane) : mesh_(mesh), kept_(mesh.vertices.size(), none) {
    heights_.reserve(mesh.vertices.size());
    for (const Point& x : mesh.vertices) heights_.push_back(height(x, plane));
  }

  CutMesh operator()() {
    for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
      if (heights_[v] <= 0.0) kept_[v] = add(mesh_.vertices[v], v);
    }
    for (const auto& corners : mesh_.triangles) clip(corners);
    return std::move(cut_);
  }

 private:
  static double height(const Point& x, const Plane& plane) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) sum += (x[i] - plane.point[i]) * plane.normal[i];
    return sum;
  }

  std::uint32_t add(const Point& vertex, std::uint32_t origin) {
    cut_.mesh.vertices.push_back(vertex);
    cut_.origin.push_back(origin);
    return static_cast<std::uint32_t>(cut_.mesh.vertices.size() - 1);
  }

  std::uint32_t crossing(std::uint32_t kept, std::uint32_t beyond) {
    const auto [at, is_new] = crossings_.try_emplace({kept, beyond}, none);
    if (!is_new) return at->second;
    const Point& a = mesh_.vertices[kept];
    const Point& b = mesh_.vertices[beyond];
    const double share = heights_[kept] / (heights_[kept] - heights_[beyond]);
    Point x;
    for (std::size_t i = 0; i < 3; ++i) x[i] = a[i] + share * (b[i] - a[i]);
    return at->second = add(x, kept);
  }

  void clip(const std::array<std::uint32_t, 3>& corners) {
    std::array<std::uint32_t, 4> polygon{};
    std::size_t size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = corners[i];
      const std::uint32_t to = corners[(i + 1) % 3];
      const bool from_kept = kept_[from] != none;
      const bool to_kept = kept_[to] != none;
      if (from_kept) polygon[size++] = kept_[from];
      // A corner in the plane is its own crossing.
      if (from_kept && !to_kept && heights_[from] < 0.0) polygon[size++] = crossing(from, to);
      if (!from_kept && to_kept && heights_[to] < 0.0) polygon[size++] = crossing(to, from);
    }
    if (size >= 3) cut_.mesh.triangles.push_back({polygon[0], polygon[1], polygon[2]});
    if (size == 4) cut_.mesh.triangles.push_back({polygon[0], polygon[2], polygon[3]});
  }

  const Mesh& mesh_;
  std::vector<double> heights_;
  std::vector<std::uint32_t> kept_;  ///< their places in the cut mesh
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> crossings_;
  CutMesh cut_;
};

}  // namespace

Plane scaled(const Plane& plane) {
  const auto& [x, y, z] = plane.normal;
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});
  return {plane.point, {x / largest, y / largest, z / largest}};
}

CutMesh cut_off(const Mesh& mesh, const Plane& plane) {
  return Cutter(mesh, plane)();
}

}  // namespace verisq
