/// Maps as the sources of distances for `verify/search/mesh_side.hpp`, primitive by primitive.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "host/threads/parallel.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/side_checker.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/mesh_side.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"
#include "verisq/map.hpp"
#include "verisq/recovery.hpp"

namespace verisq {
namespace {

/// Share of the primitive's bounding radius: the required width of distances. Distances to convex solids need no
/// search.
constexpr double finest = 1e-9;
constexpr double finest_of_bent = 1e-5;

void check(const Model& model, const Mesh& mesh) {
  if (model.primitives.empty()) throw Error(ErrorKind::input, "containment: the model has no primitives");
  if (model.csg) throw Error(ErrorKind::input, "containment: the model has set operations, not primitives alone");
  const MeshTopology topology = mesh_topology(mesh);
  if (!bounds_for_containment(topology))
    throw Error(ErrorKind::input,
                fmt::format("the mesh is not closed: {} of its edges are of one triangle, {} of more than two",
                            topology.boundary_edges, topology.non_manifold_edges));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& [x, y, z] = mesh.vertices[i];
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
      throw Error(ErrorKind::input, fmt::format("vertex {} of the mesh, ({}, {}, {}), is not finite", i, x, y, z));
  }
}

verify::SignedDistances distances_to(const Primitive& primitive, const ContainmentOptions& options) {
  const Model model{"", {primitive}, {}};
  const double radius = bounding_radius(model);
  const auto mapper = std::make_shared<PointMapper>(
      model, MapOptions{.tolerance = (is_bent(primitive) ? finest_of_bent : finest) * radius,
                        .device = options.device,
                        .interrupted = options.interrupted});
  return [mapper](std::span<const Point> points, std::span<Enclosure> rows) {
    if (points.empty()) return true;
    std::vector<Status> status(rows.size(), Status::wide);
    constexpr std::ptrdiff_t stride = sizeof(Enclosure) / sizeof(double);
    return !mapper->map(points, {rows.size(), {&rows[0].lo, stride}, {&rows[0].hi, stride}, {status.data()}})
                .interrupted;
  };
}

/// A primitive's interior is connected, holds its centre, and meets no triangle: it lies where its centre does.
std::vector<std::string> centres_outside(const Model& model, const Mesh& mesh) {
  const verify::ClosedSurface surface(verify::triangles_of(mesh));
  std::vector<std::string> outside;
  for (const Primitive& primitive : model.primitives)
    if (!surface.odd(primitive.pose.translation).value_or(false)) outside.push_back(primitive.name);
  return outside;
}

}  // namespace

bool bounds_for_containment(const MeshTopology& topology) {
  return topology.closed() && topology.non_manifold_edges == 0;
}

ContainmentProof prove_containment(const Model& model, const Mesh& mesh, Containment containment,
                                   const ContainmentOptions& options) {
  verify::require_valid(model);
  check(model, mesh);
  verify::SideSearch search{.to_solids = {},
                            .convex = {},
                            .in_parallel = in_parallel<std::function<void(std::size_t)>>,
                            .ended = options.interrupted,
                            .most_samples = options.most_samples};
  for (const Primitive& primitive : model.primitives) {
    search.to_solids.push_back(distances_to(primitive, options));
    search.convex.push_back(!is_bent(primitive));
  }
  const bool within = containment == Containment::within;
  const verify::MeshSide side =
      verify::mesh_side(mesh, within ? verify::SolidSide::outside : verify::SolidSide::inside, search);
  ContainmentProof proof{.containment = containment,
                         .triangles_proven = side.proven,
                         .triangles_refuted = side.refuted,
                         .triangles_undecided = side.undecided,
                         .samples = side.samples};
  for (const verify::PointAstray& astray : side.astray) proof.across.push_back({astray.point, astray.excess});
  if (side.proven == mesh.triangles.size()) {
    if (within) {
      proof.centres_outside = centres_outside(model, mesh);
    } else {
      proof.certificate = verify::certified_union(model.primitives, options.interrupted);
      proof.maybe_with_cavities =
          !verify::is_without_cavities(model.primitives, proof.certificate, options.interrupted);
    }
    proof.proven = proof.centres_outside.empty() && !proof.maybe_with_cavities;
  }
  proof.interrupted = options.interrupted();
  return proof;
}

}  // namespace verisq
