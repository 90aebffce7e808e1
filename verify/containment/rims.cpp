/// At every vertex as many open edges begin as end, for each triangle adds one of both: walks along them close.
#include "verify/containment/rims.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "verify/deviation/triangle_tree.hpp"

namespace verisq::verify {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

/// Those of one triangle, as it runs through them.
std::multimap<std::uint32_t, std::uint32_t> open_edges(const Mesh& mesh) {
  std::set<Edge> open;
  for (const auto& corners : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge{corners[i], corners[(i + 1) % 3]};
      if (open.erase({edge.second, edge.first}) == 0) open.insert(edge);
    }
  }
  return {open.begin(), open.end()};
}

/// Takes the edges of the walk.
std::vector<std::uint32_t> walk(std::multimap<std::uint32_t, std::uint32_t>& edges) {
  std::vector<std::uint32_t> vertices;
  auto edge = edges.begin();
  const std::uint32_t start = edge->first;
  do {
    vertices.push_back(edge->first);
    const std::uint32_t end = edge->second;
    edges.erase(edge);
    if (end == start) break;
    edge = edges.find(end);
  } while (edge != edges.end());
  return vertices;
}

Point mean_of(const Mesh& mesh, const std::vector<std::uint32_t>& vertices) {
  Point mean{};
  for (const std::uint32_t v : vertices) {
    for (std::size_t i = 0; i < 3; ++i) mean[i] += mesh.vertices[v][i] / static_cast<double>(vertices.size());
  }
  return mean;
}

}  // namespace

Closing closing_over_rims(const Mesh& mesh) {
  Closing closing;
  auto edges = open_edges(mesh);
  closing.edges = edges.size();
  if (edges.empty()) return closing;
  closing.mesh.vertices = mesh.vertices;
  for (; !edges.empty(); ++closing.rims) {
    const std::vector<std::uint32_t> rim = walk(edges);
    const auto apex = static_cast<std::uint32_t>(closing.mesh.vertices.size());
    closing.mesh.vertices.push_back(mean_of(mesh, rim));
    for (std::size_t i = 0; i < rim.size(); ++i) {
      closing.mesh.triangles.push_back({rim[(i + 1) % rim.size()], rim[i], apex});
    }
  }
  return closing;
}

std::vector<Triangle> closed_triangles(const Mesh& mesh, const Closing& closing) {
  std::vector<Triangle> triangles = triangles_of(mesh);
  const std::vector<Triangle> openings = triangles_of(closing.mesh);
  triangles.insert(triangles.end(), openings.begin(), openings.end());
  return triangles;
}

}  // namespace verisq::verify
