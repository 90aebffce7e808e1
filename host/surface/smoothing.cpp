/// The two steps of a round, over the edges of the mesh.
#include "host/surface/smoothing.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace verisq::surface {
namespace {

// 1/forward + 1/back = 0.1, the pass-band frequency that Taubin recommends, section 3.
constexpr double forward = 0.5;
constexpr double back = -1.0 / (1.0 / forward - 0.1);

using Edge = std::pair<std::uint32_t, std::uint32_t>;

struct Edges {
  std::vector<Edge> all;        ///< once each
  std::vector<bool> on_border;  ///< of each vertex
};

Edges edges_of(const Mesh& mesh) {
  std::vector<Edge> sides;
  for (const auto& [a, b, c] : mesh.triangles)
    for (const Edge& side : {std::minmax({a, b}), std::minmax({b, c}), std::minmax({c, a})}) sides.push_back(side);
  std::ranges::sort(sides);
  Edges edges{.all = {}, .on_border = std::vector<bool>(mesh.vertices.size(), false)};
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::upper_bound(first, sides.end(), *first);
    edges.all.push_back(*first);
    if (last - first == 1) edges.on_border[first->first] = edges.on_border[first->second] = true;
    first = last;
  }
  return edges;
}

/// Moves each vertex by `factor` times the way to the mean of its neighbours.
void relax(Mesh& mesh, const Edges& edges, double factor) {
  std::vector<Point> ways(mesh.vertices.size(), Point{});
  std::vector<double> neighbours(mesh.vertices.size(), 0.0);
  for (const auto& [a, b] : edges.all) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double way = mesh.vertices[b][axis] - mesh.vertices[a][axis];
      ways[a][axis] += way;
      ways[b][axis] -= way;
    }
    neighbours[a] += 1.0;
    neighbours[b] += 1.0;
  }
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    if (edges.on_border[k] || neighbours[k] == 0.0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) mesh.vertices[k][axis] += factor / neighbours[k] * ways[k][axis];
  }
}

}  // namespace

Mesh smoothed(Mesh mesh, int rounds) {
  const Edges edges = edges_of(mesh);
  for (int round = 0; round < rounds; ++round) {
    relax(mesh, edges, forward);
    relax(mesh, edges, back);
  }
  return mesh;
}

}  // namespace verisq::surface
