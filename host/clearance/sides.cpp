/// A primitive that keeps off the closed surface lies on one side of it: that of any of its points.
#include "verisq/sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "verify/containment/closed_surface.hpp"
#include "verify/containment/rims.hpp"
#include "verify/proof/convex_union.hpp"
#include "verify/sets/bend_range.hpp"
#include "verify/sets/set_tree.hpp"
#include "verisq/error.hpp"
#include "verisq/mesh_topology.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

/// Of the primitive's smallest semi-axis: how closely the depth of its centre is known.
constexpr double share_of_semi_axis = 1e-3;
/// Distances asked for of a primitive alone, where it is not the solid that is to keep off the surface.
constexpr std::uint64_t most_samples_of_sides = std::uint64_t{1} << 19U;

Model alone(const Primitive& primitive) {
  return {.units = {}, .primitives = {primitive}, .csg = {}};
}

int orientation_of(const Mesh& surface, const Closing& closing) {
  return signed_volume(surface) + signed_volume(closing.mesh) > 0.0 ? 1 : -1;
}

bool is_clear(const MeshClearance& found) {
  return found.proven_too_deep == 0 && found.undecided == 0;
}

class SideProof {
 public:
  /// `clearance` is that of a solid which holds every primitive; nothing: each is asked on its own.
  SideProof(const Mesh& surface, const MeshClearance* clearance, const SidesOptions& options)
      : surface_(surface),
        options_(options),
        closing_(closing_over_rims(surface)),
        closed_(closed_triangles(surface, closing_)),
        orientation_(orientation_of(surface, closing_)) {
    if (clearance != nullptr) clear_ = is_clear(*clearance);
  }

  [[nodiscard]] std::size_t rims() const { return closing_.rims; }

  [[nodiscard]] SideFinding operator()(const Primitive& primitive, SurfaceSide required) const {
    if (required == SurfaceSide::any) return SideFinding::kept;
    const Point& centre = primitive.pose.translation;
    const auto& semi_axes = primitive.superquadric.semi_axes;
    const double tolerance = share_of_semi_axis * std::ranges::min(semi_axes);
    if (!(SignedDistance(alone(primitive))(centre, tolerance).hi < -options_.penetration_limit)) {
      return SideFinding::no_deep_point;
    }
    if (is_bent(primitive) &&
        !verify::is_connected_below(options_.penetration_limit, *primitive.bend, primitive.superquadric)) {
      return SideFinding::strongly_bent;
    }
    const std::optional<int> winding = closed_.winding_number(centre);
    if (!winding) return SideFinding::on_the_surface;
    // Where a surface crosses itself it may wind the other way about: that is neither side.
    const bool kept = required == SurfaceSide::inside ? *winding * orientation_ > 0 : *winding == 0;
    if (!kept) return SideFinding::other_side;
    if (!keeps_off_surface(primitive)) return SideFinding::enters_surface;
    return keeps_off_openings(primitive) ? SideFinding::kept : SideFinding::reaches_through;
  }

 private:
  [[nodiscard]] bool keeps_off_surface(const Primitive& primitive) const {
    if (clear_) return *clear_;
    return is_clear(mesh_clearance(alone(primitive), surface_,
                                   {.penetration_limit = options_.penetration_limit,
                                    .tolerance = bounding_radius(alone(primitive)),  // which nobody asks for
                                    .limit_tolerance = options_.tolerance,
                                    .most_samples = most_samples_of_sides,
                                    .device = options_.device,
                                    .interrupted = options_.interrupted}));
  }

  [[nodiscard]] bool keeps_off_openings(const Primitive& primitive) const {
    if (closing_.mesh.triangles.empty()) return true;
    return is_clear(mesh_clearance(alone(primitive), closing_.mesh,
                                   {.penetration_limit = options_.penetration_limit,
                                    .tolerance = options_.tolerance,
                                    .device = options_.device,
                                    .interrupted = options_.interrupted}));
  }

  const Mesh& surface_;
  const SidesOptions& options_;
  std::optional<bool> clear_;
  Closing closing_;
  verify::ClosedSurface closed_;
  int orientation_;
};

}  // namespace

std::vector<std::uint32_t> covering_primitives(const Model& model) {
  return verify::covering_primitives(model);
}

bool Sides::kept() const {
  return std::ranges::all_of(of_primitives, [](SideFinding finding) { return finding == SideFinding::kept; });
}

bool faces_outward(const Mesh& surface) {
  return orientation_of(surface, closing_over_rims(surface)) > 0;
}

void check_surface_has_sides(const Mesh& surface) {
  const MeshTopology topology = mesh_topology(surface);
  if (topology.triangles == 0) throw Error(ErrorKind::input, "has no triangles, so that it has no sides");
  if (topology.non_manifold_edges > 0 || !topology.oriented()) {
    throw Error(ErrorKind::input,
                "has no sides: edges of more than two triangles, or triangles that are not turned alike");
  }
}

Sides prove_sides(const Model& model, const Mesh& surface, const MeshClearance& clearance,
                  std::span<const SurfaceSide> required, const SidesOptions& options) {
  check_surface_has_sides(surface);
  if (required.size() != model.primitives.size()) {
    throw Error(ErrorKind::input,
                fmt::format("sides: {} required of {} primitives", required.size(), model.primitives.size()));
  }
  const SideProof proof(surface, verify::is_union(model) ? &clearance : nullptr, options);
  Sides sides{.of_primitives = {}, .rims = proof.rims()};
  for (std::size_t k = 0; k < model.primitives.size(); ++k) {
    sides.of_primitives.push_back(proof(model.primitives[k], required[k]));
  }
  return sides;
}

}  // namespace verisq
