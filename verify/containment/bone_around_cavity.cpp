/// Branch and bound: where two surfaces have no point in common, one vertex of each part tells the side of all of it.
#include "verify/containment/bone_around_cavity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "verify/analysis/largest_coordinate.hpp"
#include "verify/containment/connected_parts.hpp"
#include "verify/deviation/triangle_piece.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/placement/quartered_triangle.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {
namespace {

/// Of the largest coordinate: pieces so small are taken to meet what is not proven to be apart from them. Far more than
/// their corners round by.
constexpr double least_piece = 1e-9;
/// Of a cavity that crosses the bone's surface one of its vertices is inside as a rule, which is soon found.
constexpr std::size_t vertices_before = 16;

/// Whether the triangle is proven to have no point in common with the others.
bool is_apart(const Triangle& triangle, const TriangleTree& others) {
  const double off = displacement(triangle);
  std::vector<Triangle> open{triangle};
  while (!open.empty()) {
    const Triangle piece = open.back();
    open.pop_back();
    const double radius = shape_of(piece, off).radius;
    if (others.nearest(centre(piece)).distance.lo > add(radius, off, Direction::up)) continue;
    if (!std::isfinite(radius) || radius < least_piece * largest_coordinate(triangle)) return false;
    for (const Triangle& part : quarters(piece)) open.push_back(part);
  }
  return true;
}

/// Whether every point of the cavity's surface is proven to be one about which the outer one does not wind.
bool is_beside(const Mesh& cavity, const ClosedSurface& outer) {
  const auto winds_about = [&](std::size_t vertex) {
    return outer.winding_number(cavity.vertices[vertex]) != std::optional(0);
  };
  const std::size_t step = 1 + cavity.triangles.size() / vertices_before;
  for (std::size_t n = 0; n < cavity.triangles.size(); n += step)
    if (winds_about(cavity.triangles[n][0])) return false;
  const std::vector<std::uint32_t> part = connected_parts(cavity);
  std::set<std::uint32_t> parts;
  for (const auto& corners : cavity.triangles) parts.insert(part[corners[0]]);
  if (std::ranges::any_of(parts, winds_about)) return false;
  const TriangleTree others(outer.triangles());
  return std::ranges::all_of(triangles_of(cavity),
                             [&](const Triangle& triangle) { return is_apart(triangle, others); });
}

}  // namespace

void require_cavities_in_bone(const BoneRegion& bone, const std::function<const ClosedSurface&(std::size_t)>& closed) {
  for (std::size_t n = 0; n < bone.surfaces.size(); ++n) {
    if (bone.surfaces[n].bone != BoneSide::inside) continue;
    for (const BoneSurface& cavity : bone.surfaces)
      if (cavity.bone == BoneSide::outside && is_beside(cavity.mesh, closed(n)))
        throw Error(ErrorKind::input,
                    "nothing of the cavity's surface is inside of the bone's outer surface: it lies beside the bone, "
                    "or around it. Are both of one bone, in the same coordinates?");
  }
}

}  // namespace verisq::verify
