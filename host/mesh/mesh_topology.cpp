/// The edges of all triangles, sorted, meet their neighbours; union-find gathers components and fans.
#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>
#include <vector>
#include <verisq/mesh_topology.hpp>

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
struct Side {
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

std::vector<Side> sides_by_edge(const Mesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
    const auto [low, high] = std::minmax({vertex_at(mesh, corner), vertex_at(mesh, next_corner(corner))});
    sides.push_back({low, high, corner});
  }
  std::ranges::sort(sides, {}, [](const Side& side) { return std::pair(side.edge(), side.corner); });
  return sides;
}

void count_edge(const Mesh& mesh, std::span<const Side> sides, MeshTopology& topology) {
  ++topology.edges;
  if (sides.size() == 1) ++topology.boundary_edges;
  if (sides.size() > 2) ++topology.non_manifold_edges;
  if (sides.size() == 2 && vertex_at(mesh, sides[0].corner) == vertex_at(mesh, sides[1].corner))
    ++topology.inconsistent_edges;
}

/// Two triangles at an edge are neighbours in the fans around both ends of it; more of them part the fans.
void unite_fans(const Mesh& mesh, std::span<const Side> sides, DisjointSets& fans) {
  if (sides.size() != 2) return;
  const auto corner_at = [&](const Side& side, std::uint32_t vertex) {
    return vertex_at(mesh, side.corner) == vertex ? side.corner : next_corner(side.corner);
  };
  fans.unite(corner_at(sides[0], sides[0].low), corner_at(sides[1], sides[0].low));
  fans.unite(corner_at(sides[0], sides[0].high), corner_at(sides[1], sides[0].high));
}

/// Calls `visit` with all sides of an edge, edge by edge.
template <class Visit>
void for_each_edge(const Mesh& mesh, const Visit& visit) {
  const std::vector<Side> sides = sides_by_edge(mesh);
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const Side& side) { return side.edge() != first->edge(); });
    visit(std::span<const Side>(first, last));
    first = last;
  }
}

/// Of each vertex. `fans` unites the corners of neighbours.
std::vector<std::uint32_t> count_fans(const Mesh& mesh, DisjointSets& fans) {
  std::vector<std::uint32_t> fans_at(mesh.vertices.size(), 0);
  for (std::size_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner)
    if (fans.root(corner) == corner) ++fans_at[vertex_at(mesh, corner)];
  return fans_at;
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
  for_each_edge(mesh, [&](std::span<const Side> sides) {
    count_edge(mesh, sides, topology);
    unite_fans(mesh, sides, fans);
    for (const Side& side : sides) components.unite(sides[0].corner / 3, side.corner / 3);
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
  for_each_edge(mesh, [&](std::span<const Side> sides) { unite_fans(mesh, sides, fans); });
  const std::vector<std::uint32_t> fans_at = count_fans(mesh, fans);
  std::vector<std::uint32_t> result;
  for (std::uint32_t vertex = 0; vertex < fans_at.size(); ++vertex)
    if (fans_at[vertex] > 1) result.push_back(vertex);
  return result;
}

double signed_volume(const Mesh& mesh) {
  // About a corner of the mesh: from a far origin the cones would be huge, and cancel.
  return mesh.triangles.empty() ? 0.0 : signed_volume(mesh, mesh.vertices[mesh.triangles[0][0]]);
}

double signed_volume(const Mesh& mesh, const Point& apex) {
  const auto from_apex = [&](std::uint32_t vertex) {
    const Point& p = mesh.vertices[vertex];
    return Point{p[0] - apex[0], p[1] - apex[1], p[2] - apex[2]};
  };
  double six_volumes = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const Point a = from_apex(triangle[0]);
    const Point b = from_apex(triangle[1]);
    const Point c = from_apex(triangle[2]);
    six_volumes +=
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six_volumes / 6.0;
}

}  // namespace verisq
