/// On which side of a surface something has to lie.
#pragma once

#include <cstdint>
#include <string_view>

namespace verisq {

/// Where a primitive has to lie.
enum class SurfaceSide : std::uint8_t {
  inside,   ///< of the surface, closed over its rims
  outside,  ///< likewise
  any,      ///< it may pass through the openings
};

/// "inside", "outside", "any".
[[nodiscard]] constexpr std::string_view to_string(SurfaceSide side) {
  switch (side) {
    case SurfaceSide::inside: return "inside";
    case SurfaceSide::outside: return "outside";
    case SurfaceSide::any: break;
  }
  return "any";
}

}  // namespace verisq
