/// Cubes that halve exactly, and how far a point is from them.
#pragma once

#include <array>
#include <optional>

#include "verify/sets/bounding_box.hpp"
#include "verify/sets/cube.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

/// Contains the box; its half-width is a power of two and a half of it divides the coordinates of the centre, so that
/// cubes far smaller still have centres in binary64. Nothing where that overflows.
[[nodiscard]] std::optional<Cube> root_cube(const Box& box);

/// The eight halves, which cover the cube. Nothing where a centre is not representable.
[[nodiscard]] std::optional<std::array<Cube, 8>> halves(const Cube& cube);

/// Exactly: false proves that x lies beyond a face.
[[nodiscard]] bool contains(const Cube& cube, const Point& x);

/// Encloses the distance of x to the cube, 0 within.
[[nodiscard]] Enclosure distance(const Point& x, const Cube& cube);

/// Encloses the distance of an x within the cube to its faces. Precondition: contains(cube, x).
[[nodiscard]] Enclosure distance_to_faces(const Point& x, const Cube& cube);

}  // namespace verisq::verify
