/// Proves on which side of a surface the parts of an implant lie: inside a cavity, outside a bone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/side_checker.hpp>
#include <verisq/surface_side.hpp>

namespace verisq {

/// Indices of primitives, ascending, that hold the model's solid together: every point of it lies in one of them, so
/// that their sides tell the solid's. All those of a union; of an intersection those of the first operand that has
/// some; of a difference those of its first one.
[[nodiscard]] std::vector<std::uint32_t> covering_primitives(const Model& model);

struct Sides {
  std::vector<SideFinding> of_primitives;  ///< `kept` for each that may lie anywhere
  std::size_t rims = 0;                    ///< over which the surface was closed, by fans about their means
  [[nodiscard]] bool kept() const;
};

/// Whether the surface, closed over its rims, is proven to face outward. Precondition: it has sides.
[[nodiscard]] bool faces_outward(const Mesh& surface);

/// Throws Error(input) unless the triangles enclose a side: manifold, and consistently oriented.
void check_surface_has_sides(const Mesh& surface);

/// Of each primitive what `SideChecker` finds. Of set operations a primitive is what its name says, all of it: whole
/// primitives are proven to keep off the surface, which is more than is asked of a solid of which parts are cut away.
/// `covering_primitives` are those that hold it. Throws Error(input) unless `required` is one a primitive, and as
/// SideChecker.
[[nodiscard]] Sides prove_sides(
    const Model& model, const Mesh& surface, std::span<const SurfaceSide> required, double penetration_limit,
    const std::function<bool()>& interrupted = [] { return false; });

/// What `SideChecker` can prove again: those sides that are kept, and not any. Precondition: `required` is what was
/// asked of the same primitives.
[[nodiscard]] std::vector<SideClaim> claims_of(const Sides& sides, std::span<const SurfaceSide> required);

}  // namespace verisq
