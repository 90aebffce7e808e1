/// Where bone is, of which an insertion takes some away, from the surfaces that bound it.
#pragma once

#include <optional>
#include <string>
#include <verisq/mesh.hpp>
#include <verisq/plane_cut.hpp>
#include <verisq/removed_volume.hpp>

namespace verisq {

struct NamedMesh {
  std::string name;  ///< stands for it in messages
  Mesh mesh;
};

/// Around a cavity, up to the bone's outer surface, the resection, or both. Throws Error(input) naming option and file
/// as `verisq insert` does, where nothing says where the bone ends, and for surfaces that are not what they should be:
/// one each, manifold and consistently oriented, the outer one's normals pointing outward, the cavity not beside it.
[[nodiscard]] BoneRegion bone_around(NamedMesh cavity, std::optional<NamedMesh> outer,
                                     const std::optional<Plane>& resection);

/// Inside the bone's outer surface. Throws likewise.
[[nodiscard]] BoneRegion bone_inside(NamedMesh outer, const std::optional<Plane>& resection);

/// What is left of a mesh. Throws Error(input) where that is nothing.
[[nodiscard]] Mesh before_resection(const NamedMesh& mesh, const Plane& resection);

}  // namespace verisq
