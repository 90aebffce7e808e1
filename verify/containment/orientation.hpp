/// Whether triangles are a closed surface, and how it is turned: what winding numbers rest on (docs/mathematics.md
/// §22).
#pragma once

#include <optional>
#include <span>

#include "verisq/mesh.hpp"

namespace verisq::verify {

/// Whether every edge, by the places of its ends, is run through as often one way as the other.
[[nodiscard]] bool is_closed(std::span<const Triangle> triangles);

/// The sign of the volume that a closed surface encloses: 1 where its normals point outward on the whole, -1 where they
/// point inward. Nothing where that is not proven, as of coordinates above 1e100, nor where the volume is below 1e-12
/// of that of the cube about it: so little roundings enclose. Precondition: at least one triangle, finite.
[[nodiscard]] std::optional<int> orientation_of(std::span<const Triangle> triangles);

}  // namespace verisq::verify
