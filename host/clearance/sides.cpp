/// A convex primitive that keeps off the closed surface lies on one side of it: that of any of its points.
#include "verisq/sides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "host/mesh/rims.hpp"
#include "verify/containment/closed_surface.hpp"
#include "verisq/error.hpp"
#include "verisq/mesh_topology.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

/// Of the primitive's smallest semi-axis: how closely the depth of its centre is known.
constexpr double share_of_semi_axis = 1e-3;

Model alone(const Primitive& primitive) {
  return {.units = {}, .primitives = {primitive}, .csg = {}};
}

int orientation_of(const Mesh& surface, const Closing& closing) {
  return signed_volume(surface) + signed_volume(closing.mesh) > 0.0 ? 1 : -1;
}

class SideProof {
 public:
  SideProof(const Mesh& surface, const MeshClearance& clearance, const SidesOptions& options)
      : options_(options),
        clear_(clearance.proven_too_deep == 0 && clearance.undecided == 0),
        closing_(closing_over_rims(surface)),
        closed_(closed_triangles(surface, closing_)),
        orientation_(orientation_of(surface, closing_)) {}

  [[nodiscard]] std::size_t rims() const { return closing_.rims; }

  [[nodiscard]] SideFinding operator()(const Primitive& primitive, SurfaceSide required) const {
    if (required == SurfaceSide::any) return SideFinding::kept;
    const Point& centre = primitive.pose.translation;
    const auto& semi_axes = primitive.superquadric.semi_axes;
    const double tolerance = share_of_semi_axis * std::ranges::min(semi_axes);
    if (!(SignedDistance(alone(primitive))(centre, tolerance).hi < -options_.penetration_limit)) {
      return SideFinding::no_deep_point;
    }
    const std::optional<int> winding = closed_.winding_number(centre);
    if (!winding) return SideFinding::on_the_surface;
    // Where a surface crosses itself it may wind the other way about: that is neither side.
    const bool kept = required == SurfaceSide::inside ? *winding * orientation_ > 0 : *winding == 0;
    if (!kept) return SideFinding::other_side;
    if (!clear_) return SideFinding::enters_surface;
    return keeps_off_openings(primitive) ? SideFinding::kept : SideFinding::reaches_through;
  }

 private:
  [[nodiscard]] bool keeps_off_openings(const Primitive& primitive) const {
    if (closing_.mesh.triangles.empty()) return true;
    const MeshClearance found = mesh_clearance(alone(primitive), closing_.mesh,
                                               {.penetration_limit = options_.penetration_limit,
                                                .tolerance = options_.tolerance,
                                                .device = options_.device,
                                                .interrupted = options_.interrupted});
    return found.proven_too_deep == 0 && found.undecided == 0;
  }

  const SidesOptions& options_;
  bool clear_;
  Closing closing_;
  verify::ClosedSurface closed_;
  int orientation_;
};

}  // namespace

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
  if (!is_union_of_convex(model)) throw Error(ErrorKind::input, "sides: only of unions of convex primitives");
  if (required.size() != model.primitives.size()) {
    throw Error(ErrorKind::input,
                fmt::format("sides: {} required of {} primitives", required.size(), model.primitives.size()));
  }
  const SideProof proof(surface, clearance, options);
  Sides sides{.of_primitives = {}, .rims = proof.rims()};
  for (std::size_t k = 0; k < model.primitives.size(); ++k) {
    sides.of_primitives.push_back(proof(model.primitives[k], required[k]));
  }
  return sides;
}

}  // namespace verisq
