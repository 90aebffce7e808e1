/// Floods over the neighbours of tetrahedra.
#include "host/surface/tetrahedra.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <verisq/mesh_topology.hpp>

namespace verisq::surface {
namespace {

/// The corners of the facet opposite to each corner, counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 3>, 4> facets{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

double volume(const Tetrahedra& tetrahedra, std::size_t k) {
  const auto& corners = tetrahedra.corners[k];
  const Point& apex = tetrahedra.points[corners[0]];
  std::array<Point, 3> sides{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) sides[i][axis] = tetrahedra.points[corners[i + 1]][axis] - apex[axis];
  const auto& [a, b, c] = sides;
  return (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
          a[2] * (b[0] * c[1] - b[1] * c[0])) /
         6.0;
}

/// All tetrahedra that paths through facets reach from `start` without leaving those of `solid` or, where that is
/// false, without entering them; marks them in `reached`.
std::vector<std::uint32_t> flood(const Tetrahedra& tetrahedra, const Solid& solid, std::uint32_t start,
                                 Solid& reached) {
  std::vector<std::uint32_t> found{start};
  reached[start] = true;
  for (std::size_t next = 0; next < found.size(); ++next) {
    for (const std::uint32_t neighbour : tetrahedra.neighbours[found[next]]) {
      if (neighbour == no_neighbour || reached[neighbour] || solid[neighbour] != solid[start]) continue;
      reached[neighbour] = true;
      found.push_back(neighbour);
    }
  }
  return found;
}

bool on_hull(const Tetrahedra& tetrahedra, std::size_t k) {
  return std::ranges::find(tetrahedra.neighbours[k], no_neighbour) != tetrahedra.neighbours[k].end();
}

/// The solid and all that cannot be reached from outside the hull.
Solid with_voids_filled(const Tetrahedra& tetrahedra, const Solid& solid) {
  Solid reached(solid.size(), false);
  for (std::uint32_t k = 0; k < solid.size(); ++k)
    if (!solid[k] && !reached[k] && on_hull(tetrahedra, k)) (void)flood(tetrahedra, solid, k, reached);
  reached.flip();
  return reached;
}

Solid largest_component(const Tetrahedra& tetrahedra, const Solid& solid) {
  std::vector<std::uint32_t> largest;
  double largest_volume = -1.0;
  Solid reached(solid.size(), false);
  for (std::uint32_t k = 0; k < solid.size(); ++k) {
    if (!solid[k] || reached[k]) continue;
    std::vector<std::uint32_t> component = flood(tetrahedra, solid, k, reached);
    double sum = 0.0;
    for (const std::uint32_t member : component) sum += volume(tetrahedra, member);
    if (sum <= largest_volume) continue;
    largest_volume = sum;
    largest = std::move(component);
  }
  Solid result(solid.size(), false);
  for (const std::uint32_t member : largest) result[member] = true;
  return result;
}

/// Of each of `vertices` the tetrahedron of the smallest circumradius that is not in the solid.
std::vector<std::uint32_t> smallest_outside(const Tetrahedra& tetrahedra, const Solid& solid,
                                            const std::vector<std::uint32_t>& vertices) {
  std::map<std::uint32_t, std::optional<std::uint32_t>> smallest;
  for (const std::uint32_t vertex : vertices) smallest[vertex];
  for (std::uint32_t k = 0; k < solid.size(); ++k) {
    if (solid[k]) continue;
    for (const std::uint32_t corner : tetrahedra.corners[k]) {
      const auto place = smallest.find(corner);
      if (place == smallest.end()) continue;
      if (!place->second || tetrahedra.circumradii[k] < tetrahedra.circumradii[*place->second]) place->second = k;
    }
  }
  std::vector<std::uint32_t> result;
  for (const auto& entry : smallest)
    if (entry.second) result.push_back(*entry.second);
  return result;
}

}  // namespace

Solid alpha_solid(const Tetrahedra& tetrahedra, double alpha) {
  Solid solid(tetrahedra.corners.size());
  for (std::size_t k = 0; k < solid.size(); ++k) solid[k] = tetrahedra.circumradii[k] <= alpha;
  return largest_component(tetrahedra, with_voids_filled(tetrahedra, solid));
}

double volume(const Tetrahedra& tetrahedra, const Solid& solid) {
  double sum = 0.0;
  for (std::size_t k = 0; k < solid.size(); ++k)
    if (solid[k]) sum += volume(tetrahedra, k);
  return sum;
}

Mesh boundary(const Tetrahedra& tetrahedra, const Solid& solid) {
  Mesh mesh{.vertices = tetrahedra.points, .triangles = {}};
  for (std::size_t k = 0; k < solid.size(); ++k) {
    if (!solid[k]) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t neighbour = tetrahedra.neighbours[k][i];
      if (neighbour != no_neighbour && solid[neighbour]) continue;
      const auto& corners = tetrahedra.corners[k];
      mesh.triangles.push_back({corners[facets[i][0]], corners[facets[i][1]], corners[facets[i][2]]});
    }
  }
  return mesh;
}

Solid with_manifold_boundary(const Tetrahedra& tetrahedra, Solid solid) {
  for (;;) {
    const std::vector<std::uint32_t> vertices = non_manifold_vertices(boundary(tetrahedra, solid));
    if (vertices.empty()) return solid;
    const std::vector<std::uint32_t> additions = smallest_outside(tetrahedra, solid, vertices);
    for (const std::uint32_t addition : additions) solid[addition] = true;
    solid = with_voids_filled(tetrahedra, solid);
  }
}

}  // namespace verisq::surface
