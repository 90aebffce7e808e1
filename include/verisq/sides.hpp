/// Proves on which side of a surface the parts of an implant lie: inside a cavity, outside a bone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/mesh_clearance.hpp>
#include <verisq/model.hpp>

namespace verisq {

/// Where a primitive has to lie.
enum class SurfaceSide : std::uint8_t {
  inside,   ///< of the surface, closed over its rims
  outside,  ///< likewise
  any,      ///< it may pass through the openings
};

enum class SideFinding : std::uint8_t {
  kept,             ///< proven
  other_side,       ///< proven to be broken: a part of the primitive is not on that side
  enters_surface,   ///< it is not proven to keep off the surface, so that it may reach through
  reaches_through,  ///< it is not proven to keep off the openings
  no_deep_point,    ///< it has no point that is known to lie deeper than the limit of penetration
  on_the_surface,   ///< rounding leaves its point's side open
  strongly_bent,    ///< its points deeper than the limit of penetration are not known to be connected
};

/// "proven", "other side", "not off the surface", "not off the openings", "centre not deep enough", "centre not
/// decided", "bend too strong for the limit".
[[nodiscard]] constexpr std::string_view to_string(SideFinding finding) {
  switch (finding) {
    case SideFinding::kept: return "proven";
    case SideFinding::other_side: return "other side";
    case SideFinding::enters_surface: return "not off the surface";
    case SideFinding::reaches_through: return "not off the openings";
    case SideFinding::no_deep_point: return "centre not deep enough";
    case SideFinding::on_the_surface: return "centre not decided";
    case SideFinding::strongly_bent: break;
  }
  return "bend too strong for the limit";
}

struct SidesOptions {
  double penetration_limit = 0.0;  ///< model units, >= 0
  double tolerance;                ///< how close to the limit triangles of an opening are still decided, > 0
  std::string device = "auto";     ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };
};

/// Indices of primitives, ascending, that hold the model's solid together: every point of it lies in one of them, so
/// that their sides tell the solid's. All those of a union; of an intersection those of the first operand that has
/// some; of a difference those of its first one.
[[nodiscard]] std::vector<std::uint32_t> covering_primitives(const Model& model);

struct Sides {
  std::vector<SideFinding> of_primitives;  ///< `kept` for each that may lie anywhere
  std::size_t rims = 0;                    ///< over which the surface was closed, by fans about their means
  [[nodiscard]] bool kept() const;
};

/// Whether the surface, closed over its rims, faces outward (its signed volume is positive, to nearest). Precondition:
/// it has sides.
[[nodiscard]] bool faces_outward(const Mesh& surface);

/// Throws Error(input) unless the triangles enclose a side: manifold, and consistently oriented.
void check_surface_has_sides(const Mesh& surface);

/// Kept by a primitive means: of its points that lie deeper in it than the limit, every one lies on the side required
/// of it (all points of its interior where the limit is 0). They form a connected set, being those of a convex solid,
/// or of one that is not bent too strongly; no point of the surface, nor of its openings, is among them, by `clearance`
/// and by proofs of their own; and for one of them its winding number is proven (docs/mathematics.md §22).
/// Inside is where the closed surface winds about a point as it does about its volume, outside where it does not wind.
/// Of set operations a primitive is what its name says, all of it: whole primitives are proven to keep off the surface,
/// which is more than is asked of a solid of which parts are cut away. `covering_primitives` are those that hold it.
/// Precondition: `clearance` is that of the same model and surface under the same limit. Throws Error(input) unless
/// `required` is one a primitive, as check_surface_has_sides, and as Mapper.
[[nodiscard]] Sides prove_sides(const Model& model, const Mesh& surface, const MeshClearance& clearance,
                                std::span<const SurfaceSide> required, const SidesOptions& options);

}  // namespace verisq
