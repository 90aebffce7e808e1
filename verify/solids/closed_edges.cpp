/// This file implements closed_edges.hpp, and the primitives that are meshes.
#include "verify/solids/closed_edges.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <string>
#include <utility>

#include "verify/solids/model.hpp"
#include "verisq/error.hpp"
#include "verisq/model.hpp"

namespace verisq {

std::vector<verify::Corners> verify::corners_by_place(const Mesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return mesh.vertices[a] < mesh.vertices[b]; });
  std::vector<std::uint32_t> number(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.vertices[order[i]] == mesh.vertices[order[i - 1]];
    number[order[i]] = same ? number[order[i - 1]] : order[i];
  }
  std::vector<Corners> corners;
  corners.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) corners.push_back({number[a], number[b], number[c]});
  return corners;
}

std::vector<verify::SidedEdge> verify::closed_edges(std::span<const Corners> triangles) {
  std::vector<SidedEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t n = 0; n < triangles.size(); ++n) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = triangles[n][k];
      const std::uint64_t to = triangles[n][(k + 1) % 3];
      if (from < to) edges.push_back({from << 32U | to, n, 1});
      if (to < from) edges.push_back({to << 32U | from, n, -1});
    }
  }
  std::ranges::sort(edges, {}, &SidedEdge::ends);
  std::size_t open = 0;
  for (auto edge = edges.begin(); edge != edges.end();) {
    const std::uint64_t ends = edge->ends;
    int sum = 0;
    for (; edge != edges.end() && edge->ends == ends; ++edge) sum += edge->direction;
    open += static_cast<std::size_t>(std::abs(sum));
  }
  if (open > 0) {
    throw Error(ErrorKind::input, "the mesh is not closed: " + std::to_string(open) +
                                      " of its edges are open, or run through the same way by both triangles");
  }
  return edges;
}

Primitive mesh_primitive(std::string name, Mesh mesh, const Pose& pose) {
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  Primitive primitive{std::move(name), {}, pose, {}, std::make_shared<const Mesh>(std::move(mesh))};
  verify::require_valid_with_meshes(Model{"", {primitive}});
  static_cast<void>(verify::closed_edges(verify::corners_by_place(*primitive.mesh)));
  return primitive;
}

}  // namespace verisq
