/// The side of a mesh on which a solid lies, and proofs that unions have no cavities.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "verify/search/mesh_distances.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/mesh.hpp"
#include "verisq/model.hpp"
#include "verisq/recovery.hpp"

namespace verisq::verify {

// Decides whether all triangles of a mesh lie on one side of a solid's boundary: branch and bound over their parts
// (docs/mathematics.md §21).

enum class SolidSide : std::uint8_t {
  outside,  ///< no point of the triangle lies in the interior of any of the solids
  inside,   ///< every point of the triangle lies in one of the solids
};

/// Some solids, each with a source of signed distances.
struct SideSearch {
  std::vector<SignedDistances> to_solids;  ///< at least one
  std::vector<bool> convex;                ///< for each solid: it is convex
  Parallel in_parallel;
  std::function<bool()> ended;             ///< polled; once true it stays so
  std::uint64_t most_samples = 1U << 24U;  ///< limit of the number of distances, about
};

/// A point of the mesh, to within rounding, that is proven to be on the other side.
struct PointAstray {
  Point point;
  double excess;  ///< a lower bound of its distance from the side where it should be; outside: from the boundary of the
                  ///< solid that contains it
};

/// Every triangle is counted once.
struct MeshSide {
  std::uint64_t proven = 0;
  std::uint64_t refuted = 0;  ///< a point of the triangle is proven to be astray
  std::uint64_t undecided = 0;
  std::vector<PointAstray> astray;  ///< the ones found among the processed points
  std::uint64_t samples = 0;        ///< number of distances used
  bool ended = false;               ///< early: the results are proven all the same
};

/// Precondition: the mesh has triangles, all coordinates are finite.
[[nodiscard]] MeshSide mesh_side(const Mesh& mesh, SolidSide side, const SideSearch& search);

/// Seeks a proof that the union of these primitives has no cavity (docs/mathematics.md §21). Empty if none is needed,
/// or a primitive is bent. `ended` is polled; once true, the search stops.
[[nodiscard]] ContainmentCertificate certified_union(std::span<const Primitive> primitives,
                                                     const std::function<bool()>& ended);

}  // namespace verisq::verify
