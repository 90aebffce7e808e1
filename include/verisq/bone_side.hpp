/// Where bone is, by the surfaces that bound it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <verisq/mesh.hpp>
#include <verisq/plane.hpp>

namespace verisq {

enum class BoneSide : std::uint8_t {
  inside,   ///< of the surface: it is the bone's outer one
  outside,  ///< it is that of a cavity in the bone
};

/// A surface, closed over its rims by fans about their means, and on which side of it bone may be. Inside is where the
/// closed surface winds about a point as it does about its volume, outside where it does not wind.
struct BoneSurface {
  Mesh mesh;
  BoneSide bone;
};

/// Bone is where all of these say so; without any, everywhere.
struct BoneRegion {
  std::vector<BoneSurface> surfaces = {};
  std::optional<Plane> resection = {};  ///< what lies beyond has been cut off before
};

}  // namespace verisq
