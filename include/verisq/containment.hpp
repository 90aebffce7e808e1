/// Proves that a model lies within the solid that a closed mesh bounds, or around it.
///
/// The mesh counts as its binary64 corners state it, its triangles may cross each other. Its solid is what they part
/// from infinity an odd number of times. A model that is proven to be around it contains all that they part from
/// infinity.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/mesh_topology.hpp>
#include <verisq/model.hpp>

namespace verisq {

enum class Containment : std::uint8_t {
  within,  ///< every point of the model is a point of the mesh's solid, its surface included
  around,  ///< every point of the mesh's solid is a point of the model
};

struct ContainmentOptions {
  std::uint64_t most_samples = 1U << 24U;  ///< distances asked for, about; then what is open stays undecided
  std::string device = "auto";             ///< as MapOptions
  std::function<bool()> interrupted = [] { return false; };  ///< polled; true ends early
};

/// A point of the mesh, to within rounding, that contradicts it.
struct PointAcross {
  Point point;
  double excess;  ///< from above: how deep in a primitive (`within`), or how far from the model (`around`)
};

struct ContainmentProof {
  bool proven = false;
  std::uint64_t triangles_proven = 0;   ///< on the side where they should be
  std::uint64_t triangles_refuted = 0;  ///< some point of the triangle is proven to be on the other
  std::uint64_t triangles_undecided = 0;
  /// `within`: of the primitives, those whose centre is not proven to lie inside the mesh.
  std::vector<std::string> centres_outside = {};
  /// `around`: nothing is proven of cavities of the model, in which parts of the mesh's solid could lie.
  bool maybe_with_cavities = false;
  std::vector<PointAcross> across = {};  ///< of the points looked at
  std::uint64_t samples = 0;
  bool interrupted = false;
};

/// Whether a mesh bounds a solid that models can be contained in: closed, and no side of more than two triangles.
[[nodiscard]] bool bounds_for_containment(const MeshTopology& topology);

/// Decides it as far as it can (docs/mathematics.md §21); `proven` false is no proof of the contrary. `around` by
/// several primitives is proven of convex ones alone. Throws Error(input) for models with set operations or without
/// primitives, meshes that do not bound a solid as above, coordinates that are not finite, and as Mapper.
[[nodiscard]] ContainmentProof prove_containment(const Model& model, const Mesh& mesh, Containment containment,
                                                 const ContainmentOptions& options);

}  // namespace verisq
