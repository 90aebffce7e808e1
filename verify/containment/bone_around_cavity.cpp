/// Branch and bound: where two surfaces have no point in common, one vertex of each part tells the side of all of it.
#include "verify/containment/bone_around_cavity.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "verify/analysis/distance_up.hpp"
#include "verify/analysis/largest_coordinate.hpp"
#include "verify/containment/closed_surface.hpp"
#include "verify/containment/rims.hpp"
#include "verify/deviation/triangle_piece.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/placement/quartered_triangle.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

/// Of the largest coordinate: pieces so small are taken to meet what is not proven to be apart from them. Far more than
/// their corners round by.
constexpr double least_piece = 1e-9;
/// Of a cavity that crosses the bone's surface one of its vertices is inside as a rule, which is soon found.
constexpr std::size_t vertices_before = 16;

/// How far the piece's points are from its middle, at most, roundings included.
double radius_of(const Triangle& piece, const Point& middle) {
  double radius = 0.0;
  for (const Point& corner : piece) radius = std::max(radius, distance_up(middle, corner));
  return radius + 0x1p-40 * largest_coordinate(piece);
}

/// Whether the triangle is proven to have no point in common with the others.
bool is_apart(const Triangle& triangle, const TriangleTree& others) {
  std::vector<Triangle> open{triangle};
  while (!open.empty()) {
    const Triangle piece = open.back();
    open.pop_back();
    const Point middle = centre(piece);
    const double radius = radius_of(piece, middle);
    if (others.nearest(middle).distance.lo > radius) continue;
    if (radius < least_piece * largest_coordinate(triangle)) return false;
    for (const Triangle& part : quarters(piece)) open.push_back(part);
  }
  return true;
}

/// Of each part that is connected through vertices one of these.
std::vector<std::uint32_t> one_vertex_of_each_part(const Mesh& mesh) {
  std::vector<std::uint32_t> leader(mesh.vertices.size());
  std::iota(leader.begin(), leader.end(), 0U);
  const auto find = [&leader](std::uint32_t vertex) {
    while (leader[vertex] != vertex) vertex = leader[vertex] = leader[leader[vertex]];
    return vertex;
  };
  for (const auto& [a, b, c] : mesh.triangles)
    for (const std::uint32_t other : {b, c}) leader[find(other)] = find(a);
  std::vector<bool> is_told(mesh.vertices.size(), false);
  std::vector<std::uint32_t> vertices;
  for (const auto& corners : mesh.triangles) {
    const std::uint32_t vertex = find(corners[0]);
    if (!is_told[vertex]) vertices.push_back(vertex);
    is_told[vertex] = true;
  }
  return vertices;
}

/// Whether every point of the cavity's surface is proven to be one about which the outer one does not wind.
bool is_beside(const Mesh& cavity, const ClosedSurface& outer) {
  const auto winds_about = [&](std::size_t vertex) {
    return outer.winding_number(cavity.vertices[vertex]) != std::optional(0);
  };
  const std::size_t step = 1 + cavity.triangles.size() / vertices_before;
  for (std::size_t n = 0; n < cavity.triangles.size(); n += step)
    if (winds_about(cavity.triangles[n][0])) return false;
  if (std::ranges::any_of(one_vertex_of_each_part(cavity), winds_about)) return false;
  const TriangleTree others(outer.triangles());
  return std::ranges::all_of(cavity.triangles, [&](const std::array<std::uint32_t, 3>& corners) {
    const auto& [a, b, c] = corners;
    return is_apart({cavity.vertices[a], cavity.vertices[b], cavity.vertices[c]}, others);
  });
}

}  // namespace

void require_cavities_in_bone(const BoneRegion& bone) {
  for (const BoneSurface& outer : bone.surfaces) {
    if (outer.bone != BoneSide::inside) continue;
    const ClosedSurface closed(closed_triangles(outer.mesh, closing_over_rims(outer.mesh)));
    for (const BoneSurface& cavity : bone.surfaces)
      if (cavity.bone == BoneSide::outside && is_beside(cavity.mesh, closed))
        throw Error(ErrorKind::input,
                    "nothing of the cavity's surface is inside of the bone's outer surface: it lies beside the bone, "
                    "or around it. Are both of one bone, in the same coordinates?");
  }
}

}  // namespace verisq::verify
