/// This file implements mesh_geometry.hpp.
#include "host/prepare/mesh_geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>
#include <vector>
#include <verisq/mesh_topology.hpp>

#include "verify/numbers/points.hpp"

namespace verisq {
namespace {

/// Disjoint sets with path halving (Tarjan, van Leeuwen: Worst-case analysis of set union algorithms, 1984).
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  [[nodiscard]] std::size_t root(std::size_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void unite(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> parent_;
};

/// One side of a triangle, from its corner `corner` to the next one. Corners are counted 3 a triangle.
struct TriangleSide {
  std::uint32_t low;  ///< the vertices, in the order of their indices
  std::uint32_t high;
  std::size_t corner;

  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> edge() const { return {low, high}; }
};

std::size_t next_corner(std::size_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

std::uint32_t vertex_at(const Mesh& mesh, std::size_t corner) {
  return mesh.triangles[corner / 3][corner % 3];
}

std::vector<TriangleSide> sides_by_edge(const Mesh& mesh) {
  std::vector<TriangleSide> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
    const auto [low, high] = std::minmax({vertex_at(mesh, corner), vertex_at(mesh, next_corner(corner))});
    sides.push_back({low, high, corner});
  }
  std::ranges::sort(sides, {}, [](const TriangleSide& side) { return std::pair(side.edge(), side.corner); });
  return sides;
}

void count_edge(const Mesh& mesh, std::span<const TriangleSide> sides, MeshTopology& topology) {
  ++topology.edges;
  if (sides.size() == 1) ++topology.boundary_edges;
  if (sides.size() > 2) ++topology.non_manifold_edges;
  if (sides.size() == 2 && vertex_at(mesh, sides[0].corner) == vertex_at(mesh, sides[1].corner))
    ++topology.inconsistent_edges;
}

/// Two triangles at an edge are neighbours in the fans around both its ends; more than two separate the fans.
void unite_fans(const Mesh& mesh, std::span<const TriangleSide> sides, DisjointSets& fans) {
  if (sides.size() != 2) return;
  const auto corner_at = [&](const TriangleSide& side, std::uint32_t vertex) {
    return vertex_at(mesh, side.corner) == vertex ? side.corner : next_corner(side.corner);
  };
  fans.unite(corner_at(sides[0], sides[0].low), corner_at(sides[1], sides[0].low));
  fans.unite(corner_at(sides[0], sides[0].high), corner_at(sides[1], sides[0].high));
}

/// Calls `visit` with all sides of an edge, edge by edge.
template <class Visit>
void for_each_edge(const Mesh& mesh, const Visit& visit) {
  const std::vector<TriangleSide> sides = sides_by_edge(mesh);
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last =
        std::find_if(first, sides.end(), [&](const TriangleSide& side) { return side.edge() != first->edge(); });
    visit(std::span<const TriangleSide>(first, last));
    first = last;
  }
}

/// The number of fans at each vertex. `fans` unites the corners of neighbours.
std::vector<std::uint32_t> count_fans(const Mesh& mesh, DisjointSets& fans) {
  std::vector<std::uint32_t> fans_at(mesh.vertices.size(), 0);
  for (std::size_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner)
    if (fans.root(corner) == corner) ++fans_at[vertex_at(mesh, corner)];
  return fans_at;
}

/// About a corner of the mesh: from a far origin the cones would be huge, and cancel. Precondition: triangles.
const Point& corner_of(const Mesh& mesh) {
  return mesh.vertices[mesh.triangles[0][0]];
}

/// `value` times 2^(3 `exponent`).
struct ScaledVolume {
  double value;
  int exponent;
};

/// In units of a power of two, in which no corner is farther than 1 from the apex along an axis. Then products of three
/// coordinates neither overflow nor underflow, except if they are negligible beside others. Ordinary sizes are rounded
/// as without units.
ScaledVolume scaled_volume(const Mesh& mesh, const Point& apex) {
  const auto farthest_by = [&](double share) {
    double farthest = 0.0;
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) {
        for (std::size_t i = 0; i < 3; ++i)
          farthest = std::max(farthest, std::abs(share * mesh.vertices[vertex][i] - share * apex[i]));
      }
    }
    return farthest;
  };
  const double share = std::isfinite(farthest_by(1.0)) ? 1.0 : 0.5;  // of each way, so that it is finite
  const double farthest = farthest_by(share);
  if (farthest == 0.0) return {0.0, 0};
  constexpr int least_exponent = -1000;  // so that the scale is finite
  const int exponent = std::max(std::ilogb(farthest) + 1, least_exponent);
  const double scale = std::ldexp(1.0, -exponent);
  const auto from_apex = [&](std::uint32_t vertex) {
    const Point& p = mesh.vertices[vertex];
    return Point{(share * p[0] - share * apex[0]) * scale, (share * p[1] - share * apex[1]) * scale,
                 (share * p[2] - share * apex[2]) * scale};
  };
  double six_volumes = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Point a = from_apex(triangle[0]);
    const Point b = from_apex(triangle[1]);
    const Point c = from_apex(triangle[2]);
    six_volumes +=
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return {six_volumes / 6.0, share < 1.0 ? exponent + 1 : exponent};
}

}  // namespace

std::int64_t MeshTopology::euler_characteristic() const {
  return static_cast<std::int64_t>(vertices) - static_cast<std::int64_t>(edges) + static_cast<std::int64_t>(triangles);
}

std::optional<std::int64_t> MeshTopology::genus() const {
  if (!bounds_solid()) return std::nullopt;
  return static_cast<std::int64_t>(components) - euler_characteristic() / 2;
}

MeshTopology mesh_topology(const Mesh& mesh) {
  MeshTopology topology;
  topology.triangles = mesh.triangles.size();
  DisjointSets fans(3 * mesh.triangles.size());
  DisjointSets components(mesh.triangles.size());
  for_each_edge(mesh, [&](std::span<const TriangleSide> sides) {
    count_edge(mesh, sides, topology);
    unite_fans(mesh, sides, fans);
    for (const TriangleSide& side : sides) components.unite(sides[0].corner / 3, side.corner / 3);
  });
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    if (components.root(k) == k) ++topology.components;
  for (const std::uint32_t count : count_fans(mesh, fans)) {
    if (count > 0) ++topology.vertices;
    if (count > 1) ++topology.non_manifold_vertices;
  }
  return topology;
}

std::vector<std::uint32_t> non_manifold_vertices(const Mesh& mesh) {
  DisjointSets fans(3 * mesh.triangles.size());
  for_each_edge(mesh, [&](std::span<const TriangleSide> sides) { unite_fans(mesh, sides, fans); });
  const std::vector<std::uint32_t> fans_at = count_fans(mesh, fans);
  std::vector<std::uint32_t> result;
  for (std::uint32_t vertex = 0; vertex < fans_at.size(); ++vertex)
    if (fans_at[vertex] > 1) result.push_back(vertex);
  return result;
}

double signed_volume(const Mesh& mesh) {
  return mesh.triangles.empty() ? 0.0 : signed_volume(mesh, corner_of(mesh));
}

double signed_volume(const Mesh& mesh, const Point& apex) {
  const ScaledVolume volume = scaled_volume(mesh, apex);
  return std::ldexp(volume.value, 3 * volume.exponent);
}

int volume_sign(const Mesh& mesh) {
  return mesh.triangles.empty() ? 0 : volume_sign(mesh, corner_of(mesh));
}

int volume_sign(const Mesh& mesh, const Point& apex) {
  const double volume = scaled_volume(mesh, apex).value;
  return (volume > 0.0) - (volume < 0.0);
}

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
  return Cutter(mesh, {plane.point, verify::near_one(plane.normal)})();
}

}  // namespace verisq
